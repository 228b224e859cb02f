// All forms of the fitness for one pair of maps, reused from match to match to save allocations.
#pragma once

#include "topogeo/matching/fitness_combined.hpp"
#include "topogeo/matching/fitness_printed.hpp"
#include "topogeo/matching/fitness_weighted.hpp"

namespace topogeo::localization {

class FitnessForms {
 public:
  /// bind() before use.
  FitnessForms() = default;
  FitnessForms(const Reference& reference, const MatchFeatures& query, const MatchTask& task) {
    bind(reference, query, task);
  }

  /// The maps must outlive their use. Allocates only for a larger map than ever before.
  void bind(const Reference& reference, const MatchFeatures& query, const MatchTask& task) {
    form_ = task.fitness_form;
    combined_.bind(reference, query, task);
    if (form_ == FitnessForm::kPrinted) printed_.bind(reference, query);
    if (form_ == FitnessForm::kTopologicalWeighted) weighted_.bind(reference, query, task);
  }

  /// The form that the task names.
  [[nodiscard]] const Fitness& chosen() const {
    if (form_ == FitnessForm::kPrinted) return printed_;
    if (form_ == FitnessForm::kTopological) return combined_.topological();
    if (form_ == FitnessForm::kTopologicalWeighted) return weighted_;
    return combined_;
  }
  /// Fitness by the maps alone: without the odometry prior that two of the forms have.
  [[nodiscard]] double of_maps(const geometry::Pose2& T_reference_query,
                               const geometry::SinCos& heading) const {
    if (form_ == FitnessForm::kTopologicalWeighted) {
      return weighted_.of_maps(T_reference_query, heading);
    }
    if (form_ == FitnessForm::kCombined) return combined_.of_maps(T_reference_query, heading);
    return chosen().at(T_reference_query, heading);
  }
  [[nodiscard]] const CombinedFitness& combined() const { return combined_; }

 private:
  FitnessForm form_ = FitnessForm::kCombined;
  PrintedFitness printed_;
  CombinedFitness combined_;
  WeightedFitness weighted_;
};

}  // namespace topogeo::localization
