// Settings of the localizer service: of SLAM and of localization in a finished map.
#pragma once

#include <cstdint>

#include "topogeo/matching/match_config.hpp"
#include "topogeo/slam/added_mode_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

enum class SlamAlgorithm : std::uint8_t {
  kGraph = 0,   ///< PoseGraphSlam: pose graph over all accepted matches
  kThesis = 1,  ///< only the forward and backward correction of the thesis (AddedMode)
};

/// Whether the maps of two robots that have seen the same place are merged (SharedMap).
enum class MergePolicy : std::uint8_t {
  kAuto = 0,  ///< always
  kAsk = 1,   ///< after an operator agrees
};

struct LocalizerConfig {
  SlamAlgorithm mode = SlamAlgorithm::kGraph;  ///< algorithm that make_slam() creates
  std::uint64_t seed = 1;
  OdometryNoise odometry;
  GeneticParameters genetic;
  FitnessForm fitness_form = FitnessForm::kCombined;
  MatchEvidence evidence = MatchEvidence::kScan;
  std::uint32_t solutions_wanted = 3;
  double search_probability = 0.95;
  double search_heading_sigmas = 3.0;
  double largest_half_width_m = 3.0;
  double largest_half_width_rad = 3.1;
  double recent_way_m = 6.0;
  std::uint32_t recent_matches = 3;
  std::uint32_t revisit_matches = 3;
  double smallest_expected_overlap = 0.35;
  double unaided_correction_m = 0.6;
  double unaided_correction_rad = 0.1;
  std::uint32_t optimization_delay = 2;
  std::uint32_t final_passes = 3;
  MergePolicy merge = MergePolicy::kAuto;
  GateConfig gate;
  AddedModeConfig added_mode;
};

/// Declares the sections `localizer`, `odometry`, `match` and `gate`, and those of the added mode.
void describe(LocalizerConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument if the program does not have the mode or the form of the fitness.
void check(const LocalizerConfig& config);

}  // namespace topogeo::localization
