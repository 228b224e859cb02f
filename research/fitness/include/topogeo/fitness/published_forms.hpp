// Adds the forms of the fitness that only research and comparisons use to a program.
#pragma once

namespace topogeo::localization {

/// Makes FitnessForm::kPrinted and kTopologicalWeighted available (add_fitness_form()).
void add_published_forms();

}  // namespace topogeo::localization
