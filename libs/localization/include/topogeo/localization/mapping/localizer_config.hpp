// Settings of the localizer.
#pragma once

#include <cstdint>

#include "topogeo/localization/matching/match_config.hpp"
#include "topogeo/localization/matching/odometry_config.hpp"

namespace topogeo::localization {

enum class LocalizerMode : std::uint8_t {
  kGraph = 0,   ///< Localizer: a pose graph over all accepted matches
  kThesis = 1,  ///< ThesisLocalizer: forward and backward correction of the Thesis alone
};

struct LocalizerConfig {
  LocalizerMode mode = LocalizerMode::kGraph;  ///< which make_slam() makes
  std::uint64_t seed = 1;
  OdometryNoise odometry;
  GeneticParameters genetic;
  FitnessForm fitness_form = FitnessForm::kCombined;
  std::uint32_t solutions_wanted = 3;
  double search_probability = 0.95;  ///< of the error ellipse whose rectangle is searched (Thesis,
                                     ///< eq. 6.22; docs/algorithms.md, "Odometry model and search
                                     ///< space")
  double search_heading_sigmas = 3.0;
  double largest_half_width_m =
      3.0;  ///< of a search space; beyond it a match waits for a better prediction
  double largest_half_width_rad = 3.1;
  double recent_way_m = 6.0;  ///< stops at most this far back along the path are recent, older
                              ///< ones revisited
  std::uint32_t recent_matches = 3;         ///< tasks per step against recent stops
  std::uint32_t revisit_matches = 3;        ///< tasks per step against older stops
  double smallest_expected_overlap = 0.35;  ///< of two maps, before a task is spent on them
  double unaided_correction_m =
      0.6;  ///< a loop that moves the robot further needs a second one that agrees
  double unaided_correction_rad = 0.1;
  std::uint32_t optimization_delay = 2;  ///< steps from a closed loop to its effect on old poses
  std::uint32_t final_passes = 3;        ///< rounds of revisit matching when the log has ended
  GateConfig gate;
};

}  // namespace topogeo::localization
