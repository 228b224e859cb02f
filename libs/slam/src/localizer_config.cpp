#include "topogeo/slam/localizer_config.hpp"

#include <stdexcept>
#include <string>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

namespace {

constexpr const char* kNotBuilt = "is not built into this program (CMake option TOPOGEO_RESEARCH)";

void describe_matches(LocalizerConfig& l, support::ConfigSchema& schema) {
  describe(l.genetic, schema);
  schema.add(
      "match.fitness", &l.fitness_form,
      {{"combined", FitnessForm::kCombined},
       {"topological", FitnessForm::kTopological},
       {"topological_weighted", FitnessForm::kTopologicalWeighted},
       {"printed", FitnessForm::kPrinted}},
      "combined: nodes, branches, scan points and the odometry prior; topological: nodes and "
      "branches; topological_weighted: nodes and branches weighted by their repeatability, and the "
      "odometry prior; printed: the equations as printed in the thesis, for comparison");
  schema.add(
      "match.evidence", &l.evidence,
      {{"scan", MatchEvidence::kScan},
       {"branches", MatchEvidence::kBranches},
       {"fitness", MatchEvidence::kFitness}},
      "scan: scan points refine a solution and decide whether it is accepted; branches: the walls "
      "implied by branches and their clearances do so; fitness: nothing does, as in the thesis");
  schema.add("match.solutions", &l.solutions_wanted, 1U, 40U, "",
             "best distinct solutions kept per match");
  schema.add(
      "match.search_probability", &l.search_probability, 0.01, 0.9999, "",
      "probability of the error ellipse whose bounding rectangle is searched (Thesis, eq. 6.22)");
  schema.add("match.search_heading_sigmas", &l.search_heading_sigmas, 0.5, 6.0, "",
             "half-width of the searched heading interval in standard deviations");
  describe(l.gate, schema);
  schema.fix({"match.search_probability"});
}

void describe_tasks(LocalizerConfig& l, support::ConfigSchema& schema) {
  schema.add("localizer.recent_way_m", &l.recent_way_m, 0.5, 1000.0, "m",
             "stops up to this travelled distance ago are recent; older ones can close loops");
  schema.add("localizer.recent_matches", &l.recent_matches, 1U, 64U, "",
             "match tasks per stop against recent stops");
  schema.add("localizer.revisit_matches", &l.revisit_matches, 0U, 64U, "",
             "match tasks per stop against older stops; 0: no loops are closed");
  schema.add("localizer.smallest_expected_overlap", &l.smallest_expected_overlap, 0.0, 1.0, "",
             "smallest expected overlap of two maps for a match task");
  schema.add("localizer.largest_half_width_m", &l.largest_half_width_m, 0.1, 100.0, "m",
             "largest half-width of the predicted search space for a direct match; a less certain "
             "stop goes through place recognition first");
  schema.add("localizer.largest_half_width_rad", &l.largest_half_width_rad, 0.05, 3.1416, "rad",
             "the same limit for the heading");
  schema.add("localizer.unaided_correction_m", &l.unaided_correction_m, 0.0, 100.0, "m",
             "a loop that moves the robot further than this needs a second loop that agrees");
  schema.add("localizer.unaided_correction_rad", &l.unaided_correction_rad, 0.0, 3.1416, "rad",
             "the same limit for the heading");
  schema.add("localizer.optimization_delay", &l.optimization_delay, 0U, 100U, "stops",
             "stops between a closed loop and the correction of old poses, so that the loops of "
             "these stops count too");
  schema.add("localizer.final_passes", &l.final_passes, 0U, 20U, "",
             "passes of matching between neighbouring places after the end of a log");
  schema.add("localizer.merge", &l.merge,
             {{"auto", MergePolicy::kAuto}, {"ask", MergePolicy::kAsk}},
             "auto: the maps of robots that map one floor together become one as soon as both have "
             "seen the same place; ask: only after an operator accepts (topogeo store merges)");
  schema.fix({"localizer.optimization_delay", "localizer.largest_half_width_rad"});
}

}  // namespace

void describe(LocalizerConfig& config, support::ConfigSchema& schema) {
  describe(config.odometry, schema);
  describe_matches(config, schema);
  schema.add("localizer.mode", &config.mode,
             {{"graph", SlamAlgorithm::kGraph}, {"thesis", SlamAlgorithm::kThesis}},
             "graph: a pose graph over all accepted matches; thesis: only the forward and backward "
             "correction of the thesis, for comparison");
  schema.add(
      "localizer.seed", &config.seed, std::uint64_t{0}, ~std::uint64_t{0}, "",
      "seed of all random numbers; the same log, seed and configuration give the same bytes");
  describe_tasks(config, schema);
  if (AddedMode* const added = config.added_mode.get()) {
    added->describe(schema);
  } else {
    for (const char* section : {"thesis", "backward"}) schema.refuse_section(section, kNotBuilt);
  }
}

void check(const LocalizerConfig& config) {
  if (config.mode == SlamAlgorithm::kThesis && config.added_mode.get() == nullptr) {
    throw std::invalid_argument(std::string("localizer.mode: 'thesis' ") + kNotBuilt +
                                ", expected 'graph'");
  }
  if (!has_fitness_form(config.fitness_form)) {
    throw std::invalid_argument(std::string("match.fitness: '") + to_string(config.fitness_form) +
                                "' " + kNotBuilt + ", expected 'combined' or 'topological'");
  }
}

}  // namespace topogeo::localization
