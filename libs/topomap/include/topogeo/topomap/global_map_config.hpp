// Settings of the fusion of local maps into the global map.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::topomap {

/// How branches of local maps are fused.
enum class FusionRule : std::uint8_t {
  kVotes = 0,  ///< ridges of the votes of all views
  kPairs = 1,  ///< equivalent branches joined in pairs, as in the thesis (7.25-7.27)
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
