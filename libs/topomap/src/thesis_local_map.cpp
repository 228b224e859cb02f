#include "topogeo/topomap/thesis_local_map.hpp"

namespace topogeo::topomap {

LocalMapConfig thesis_local_map() {
  LocalMapConfig config;
  config.points_range_m = 4.0;
  config.separated_m = 0.5;
  config.largest_hidden_share = 1.0;
  config.min_stretch_m = 0.2;
  config.min_main_graph_m = 0.0;
  config.remove_off_main_graph = false;
  config.find_states = true;
  config.door_half_width_m = 0.6;
  config.door_min_half_width_m = 0.0;
  config.state_rise_m = 0.15;
  config.state_confirm_m = 0.15;
  config.state_reach_m = 0.35;
  config.plateau_m = 0.1;
  config.corridor_length_m = 1.5;
  config.hall_rise_m = 0.3;
  return config;
}

}  // namespace topogeo::topomap
