#include "topogeo/localization/thesis/thesis_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(BackwardConfig& config, support::ConfigSchema& schema) {
  schema.add("backward.beam_width", &config.beam_width, 1U, 100'000U, "paths",
             "that advance together along a cycle; wider finds better ones, at a cost in "
             "proportion");
  schema.add("backward.waiting", &config.waiting, 0U, 100'000U, "paths",
             "kept at each pose for backtracking");
  schema.add("backward.largest_work", &config.largest_work, std::uint64_t{0},
             std::uint64_t{1'000'000'000}, "steps",
             "tried in all for one cycle, so that one without consistent poses ends too");
  schema.add("backward.probability", &config.probability, 0.01, 0.9999, "",
             "of the error ellipse whose rectangle a pose must lie in: a cycle needs all its poses "
             "inside, so 0.95 for each would refuse many right ones");
  schema.add("backward.heading_sigmas", &config.heading_sigmas, 0.5, 6.0, "",
             "half-width of the headings of a pose in standard deviations");
  schema.add("backward.draw", &config.draw,
             "each step is tried a second time, drawn towards the expected pose; the thesis tries "
             "the stored solutions alone");
  schema.add("backward.solutions", &config.paths_wanted, 1U, 1000U, "",
             "of a closed cycle that are kept, by their summed fitness; the first one becomes the "
             "trajectory");
  schema.add("backward.intermediate_steps", &config.intermediate_steps, 1U, 100'000U, "",
             "tried at most where two stops were not matched but both with a third one: each "
             "solution with the one times each with the other (Thesis, eq. 7.23 and 7.24); 9 as of "
             "three solutions each, 1600 are all of 40");
  schema.add("backward.largest_grid", &config.largest_grid, 1U, 1'000'000U, "poses",
             "tried for a step between two stops of which nothing overlaps; the space of a wider "
             "uncertainty is tried in wider steps");
}

void describe(ThesisConfig& config, support::ConfigSchema& schema) {
  schema.add("thesis.matches", &config.matches, 1U, 64U, "",
             "tasks per stop against the maps that it overlaps with, best first; more of them "
             "hardly ever hold the fittest match");
  schema.add("thesis.cycle_solutions", &config.cycle_solutions, 1U, 40U, "",
             "solutions kept of a match with a map seen again; 40 as in the thesis");
  schema.add("thesis.alternations", &config.alternations, 1U, 20U, "",
             "of forward and backward correction at one stop, at most: after one cycle has closed "
             "another one may");
  describe(config.backward, schema);
}

}  // namespace topogeo::localization
