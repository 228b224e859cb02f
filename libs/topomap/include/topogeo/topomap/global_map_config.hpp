// Settings of the global map, which local maps are fused into.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::topomap {

/// How the branches of local maps become those of the global one.
enum class FusionRule : std::uint8_t {
  kVotes = 0,  ///< ridges of the votes of all views
  kPairs = 1,  ///< equivalent ones are joined in pairs, as the thesis prints it (7.25-7.27)
};

struct GlobalMapConfig {
  FusionRule fusion = FusionRule::kVotes;
  double cell_m = 0.1;
  double vote_radius_m = 0.25;
  double gap_m = 0.6;
  double node_merge_m = 0.5;
  double clearance_tolerance_m = 0.4;
  double uncertain_weight = 0.25;
  double keep_share = 0.4;
  double bridge_share = 0.12;
  double memory_views = 20.0;
  std::uint32_t min_observations = 1;
  double hole_m2 = 0.3;
  double spur_m = 0.6;
  double min_component_m = 1.0;
  double join_m = 1.0;
};

/// Declares the section `global_map`.
void describe(GlobalMapConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const GlobalMapConfig& config);

}  // namespace topogeo::topomap
