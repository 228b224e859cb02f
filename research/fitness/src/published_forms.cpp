#include "topogeo/fitness/published_forms.hpp"

#include <memory>

#include "topogeo/fitness/fitness_printed.hpp"
#include "topogeo/fitness/fitness_weighted.hpp"
#include "topogeo/matching/fitness_forms.hpp"

namespace topogeo::localization {

void add_published_forms() {
  add_fitness_form(FitnessForm::kPrinted, []() -> std::unique_ptr<AddedFitness> {
    return std::make_unique<PrintedFitness>();
  });
  add_fitness_form(FitnessForm::kTopologicalWeighted, []() -> std::unique_ptr<AddedFitness> {
    return std::make_unique<WeightedFitness>();
  });
}

}  // namespace topogeo::localization
