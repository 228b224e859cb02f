#include "topogeo/matching/fitness_forms.hpp"

#include "fitness_combined.hpp"
#include "fitness_printed.hpp"
#include "fitness_weighted.hpp"

namespace topogeo::localization {

struct FitnessForms::Forms {
  FitnessForm form = FitnessForm::kCombined;
  PrintedFitness printed;
  CombinedFitness combined;
  WeightedFitness weighted;
};

FitnessForms::FitnessForms() : forms_(std::in_place) {}
FitnessForms::FitnessForms(const Reference& reference, const MatchFeatures& query,
                           const MatchTask& task)
    : FitnessForms() {
  bind(reference, query, task);
}
FitnessForms::FitnessForms(const FitnessForms&) = default;
FitnessForms::FitnessForms(FitnessForms&&) noexcept = default;
FitnessForms& FitnessForms::operator=(const FitnessForms&) = default;
FitnessForms& FitnessForms::operator=(FitnessForms&&) noexcept = default;
FitnessForms::~FitnessForms() = default;

void FitnessForms::bind(const Reference& reference, const MatchFeatures& query,
                        const MatchTask& task) {
  forms_->form = task.fitness_form;
  forms_->combined.bind(reference, query, task);
  if (forms_->form == FitnessForm::kPrinted) forms_->printed.bind(reference, query);
  if (forms_->form == FitnessForm::kTopologicalWeighted) {
    forms_->weighted.bind(reference, query, task);
  }
}

const Fitness& FitnessForms::chosen() const {
  switch (forms_->form) {
    case FitnessForm::kPrinted:
      return forms_->printed;
    case FitnessForm::kTopological:
      return forms_->combined.topological();
    case FitnessForm::kTopologicalWeighted:
      return forms_->weighted;
    case FitnessForm::kCombined:
      break;
  }
  return forms_->combined;
}

double FitnessForms::of_maps(const geometry::Pose2& T_reference_query,
                             const geometry::SinCos& heading) const {
  if (forms_->form == FitnessForm::kTopologicalWeighted) {
    return forms_->weighted.of_maps(T_reference_query, heading);
  }
  if (forms_->form == FitnessForm::kCombined) {
    return forms_->combined.of_maps(T_reference_query, heading);
  }
  return chosen().at(T_reference_query, heading);
}

FitnessForms::Parts FitnessForms::parts(const geometry::Pose2& T) const {
  const CombinedFitness& combined = forms_->combined;
  return {combined.scan()(T), combined.topological()(T), combined.prior()(T)};
}

const CombinedFitness& FitnessForms::combined() const {
  return forms_->combined;
}

}  // namespace topogeo::localization
