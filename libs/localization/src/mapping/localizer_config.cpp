#include "topogeo/localization/mapping/localizer_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

namespace {

void describe_matches(LocalizerConfig& l, support::ConfigSchema& schema) {
  describe(l.genetic, schema);
  schema.add("match.fitness", &l.fitness_form,
             {{"combined", FitnessForm::kCombined},
              {"topological", FitnessForm::kTopological},
              {"topological_weighted", FitnessForm::kTopologicalWeighted},
              {"printed", FitnessForm::kPrinted}},
             "combined: nodes, branches, scan points and the odometry prior; topological: nodes "
             "and branches; topological_weighted: the same by how surely they are found again, and "
             "the odometry prior; printed: the equations as the thesis prints them, for "
             "comparison");
  schema.add("match.evidence", &l.evidence,
             {{"scan", MatchEvidence::kScan},
              {"branches", MatchEvidence::kBranches},
              {"fitness", MatchEvidence::kFitness}},
             "scan: scan points refine a solution and decide whether it is accepted; branches: "
             "the walls that branches and their clearances stand for do; fitness: nothing does, as "
             "in the thesis");
  schema.add("match.solutions", &l.solutions_wanted, 1U, 40U, "",
             "best distinct solutions kept of a match");
  schema.add("match.search_probability", &l.search_probability, 0.01, 0.9999, "",
             "probability of the error ellipse whose rectangle is searched (Thesis, eq. 6.22)");
  schema.add("match.search_heading_sigmas", &l.search_heading_sigmas, 0.5, 6.0, "",
             "half-width of the searched headings in standard deviations");
  describe(l.gate, schema);
}

void describe_tasks(LocalizerConfig& l, support::ConfigSchema& schema) {
  schema.add("localizer.recent_way_m", &l.recent_way_m, 0.5, 1000.0, "m",
             "stops up to this much travelled distance ago are recent, older ones close loops");
  schema.add("localizer.recent_matches", &l.recent_matches, 1U, 64U, "",
             "tasks per stop against recent stops");
  schema.add("localizer.revisit_matches", &l.revisit_matches, 0U, 64U, "",
             "tasks per stop against older stops; 0: loops are not closed");
  schema.add("localizer.smallest_expected_overlap", &l.smallest_expected_overlap, 0.0, 1.0, "",
             "of two maps before a task is spent on them");
  schema.add("localizer.largest_half_width_m", &l.largest_half_width_m, 0.1, 100.0, "m",
             "a stop is matched directly where its predicted search space is no wider than this to "
             "each side; elsewhere the place is looked for first");
  schema.add("localizer.largest_half_width_rad", &l.largest_half_width_rad, 0.05, 3.1416, "rad",
             "the same for the heading");
  schema.add("localizer.unaided_correction_m", &l.unaided_correction_m, 0.0, 100.0, "m",
             "a loop that moves the robot further than this needs a second one that agrees");
  schema.add("localizer.unaided_correction_rad", &l.unaided_correction_rad, 0.0, 3.1416, "rad",
             "the same for the heading");
  schema.add("localizer.optimization_delay", &l.optimization_delay, 0U, 100U, "stops",
             "from a closed loop to its effect on old poses: the loops of the next stops count "
             "too");
  schema.add("localizer.final_passes", &l.final_passes, 0U, 20U, "",
             "rounds of matching between places that lie near each other after the end of a log");
  schema.add("localizer.merge", &l.merge,
             {{"auto", MergePolicy::kAuto}, {"ask", MergePolicy::kAsk}},
             "of robots that map one floor at a time, auto: their maps become one as soon as they "
             "have seen the same place; ask: when somebody agrees (topogeo store merges)");
}

}  // namespace

void describe(LocalizerConfig& config, support::ConfigSchema& schema) {
  describe(config.odometry, schema);
  describe_matches(config, schema);
  schema.add("localizer.mode", &config.mode,
             {{"graph", LocalizerMode::kGraph}, {"thesis", LocalizerMode::kThesis}},
             "graph: a pose graph over all accepted matches; thesis: the forward and backward "
             "correction of the thesis alone, for comparison");
  schema.add("localizer.seed", &config.seed, std::uint64_t{0}, ~std::uint64_t{0}, "",
             "of everything random; the same log, seed and configuration give the same bytes");
  describe_tasks(config, schema);
  describe(config.thesis, schema);
}

}  // namespace topogeo::localization
