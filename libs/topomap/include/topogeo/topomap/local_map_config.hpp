// Settings of the local topo-geometric map.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::topomap {

/// Rule that decides which places along a branch are states.
enum class StateRule : std::uint8_t {
  kFloors = 0,  ///< minima and plateaus of the clearance, confirmed on both sides
  kSlopes = 1,  ///< each confirmed change of slope, as printed in the thesis (5.1-5.4)
};

struct LocalMapConfig {
  double points_range_m = 50.0;
  double separated_m = 0.5;  ///< also: an outer branch ends before the first step longer than this

  double largest_hidden_share = 0.2;  ///< see voronoi::Frontier
  double min_stretch_m = 0.2;
  double min_main_graph_m = 1.0;
  bool remove_off_main_graph = false;

  bool find_states = true;
  StateRule state_rule = StateRule::kFloors;
  double door_half_width_m = 0.6;
  double door_min_half_width_m = 0.275;
  double state_rise_m = 0.1;
  double state_confirm_m = 0.15;
  double state_reach_m = 0.35;
  double plateau_m = 0.1;
  double corridor_length_m = 1.5;
  double hall_rise_m = 0.3;
};

/// Declares the part of the section `local_map` for the map made from the diagram.
void describe(LocalMapConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const LocalMapConfig& config);

}  // namespace topogeo::topomap
