// All forms of the fitness for one pair of maps, kept from match to match for their memory.
#pragma once

#include "topogeo/localization/matching/fitness_combined.hpp"
#include "topogeo/localization/matching/fitness_printed.hpp"

namespace topogeo::localization {

class FitnessForms {
 public:
  /// bind() before use.
  FitnessForms() = default;
  FitnessForms(const Reference& reference, const MatchFeatures& query, const MatchTask& task) {
    bind(reference, query, task);
  }

  /// The maps must live as long as they are used. Allocates only for a larger map than ever before.
  void bind(const Reference& reference, const MatchFeatures& query, const MatchTask& task) {
    form_ = task.fitness_form;
    combined_.bind(reference, query, task);
    if (form_ == FitnessForm::kPrinted) printed_.bind(reference, query);
  }

  /// The one that the task names.
  [[nodiscard]] const Fitness& chosen() const {
    if (form_ == FitnessForm::kPrinted) return printed_;
    if (form_ == FitnessForm::kTopological) return combined_.topological();
    return combined_;
  }
  [[nodiscard]] const CombinedFitness& combined() const { return combined_; }

 private:
  FitnessForm form_ = FitnessForm::kCombined;
  PrintedFitness printed_;
  CombinedFitness combined_;
};

}  // namespace topogeo::localization
