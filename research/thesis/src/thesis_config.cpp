#include "topogeo/thesis/thesis_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(BackwardConfig& config, support::ConfigSchema& schema) {
  schema.add("backward.beam_width", &config.beam_width, 1U, 100'000U, "paths",
             "paths that advance together along a cycle; a wider beam finds better paths at a "
             "proportional cost");
  schema.add("backward.waiting", &config.waiting, 0U, 100'000U, "paths",
             "paths kept at each pose for backtracking");
  schema.add("backward.largest_work", &config.largest_work, std::uint64_t{0},
             std::uint64_t{1'000'000'000}, "steps",
             "most steps tried for one cycle, so that a search without consistent poses ends");
  schema.add("backward.probability", &config.probability, 0.01, 0.9999, "",
             "probability of the error ellipse whose bounding rectangle must contain a pose; a "
             "cycle needs all its poses inside, so 0.95 each would reject many correct cycles");
  schema.add("backward.heading_sigmas", &config.heading_sigmas, 0.5, 6.0, "",
             "half-width of a pose's heading interval in standard deviations");
  schema.add("backward.draw", &config.draw,
             "tries each step a second time, drawn towards the expected pose; the thesis tries "
             "only the stored solutions");
  schema.add("backward.solutions", &config.paths_wanted, 1U, 1000U, "",
             "solutions kept of a closed cycle, the largest summed fitness first; the first one "
             "becomes the trajectory");
  schema.add("backward.intermediate_steps", &config.intermediate_steps, 1U, 100'000U, "",
             "most steps tried between two stops that were matched only with a common third one: "
             "each solution of one match with each of the other (Thesis, eq. 7.23 and 7.24); 9 for "
             "three solutions each, 1600 for 40 each");
  schema.add("backward.largest_grid", &config.largest_grid, 1U, 1'000'000U, "poses",
             "most poses tried for a step between two stops without any overlap; a larger "
             "uncertainty is sampled more coarsely");
  schema.fix({"backward.largest_work", "backward.heading_sigmas", "backward.largest_grid"});
}

void describe(ThesisConfig& config, support::ConfigSchema& schema) {
  schema.add("thesis.matches", &config.matches, 1U, 64U, "",
             "match tasks per stop against overlapping maps, best first; further tasks rarely find "
             "the fittest match");
  schema.add("thesis.cycle_solutions", &config.cycle_solutions, 1U, 40U, "",
             "solutions kept of a match with a revisited map; 40 as in the thesis");
  schema.add("thesis.alternations", &config.alternations, 1U, 20U, "",
             "most alternations of forward and backward correction at one stop, because a closed "
             "cycle may let another one close");
  schema.add("thesis.kept_solutions", &config.kept_solutions, 0U, 100U, "",
             "distinct solutions of backward corrections that are kept, each correction from the "
             "poses of the forward correction alone; the one at whose poses the maps overlap best "
             "gives the trajectory. 0: the best solution of each correction at once becomes the "
             "trajectory");
  schema.add("thesis.cycle_candidates", &config.cycle_candidates, 1U, 1000U, "",
             "poses of the last stop that are traced back one by one for distinct solutions, the "
             "fittest first");
  describe(config.backward, schema);
  schema.fix({"thesis.cycle_solutions", "thesis.alternations", "thesis.cycle_candidates"});
}

}  // namespace topogeo::localization
