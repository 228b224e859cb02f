#include "topogeo/voronoi/thesis_voronoi.hpp"

namespace topogeo::voronoi {

VoronoiConfig thesis_voronoi() {
  VoronoiConfig config;
  config.range_limit_m = 4.0;
  config.resolution_m = 0.05;
  config.window_of_groups = true;
  config.forward_rad = 0.0;
  config.dropout_rad = 0.035;
  config.split_discontinuities = true;
  config.discontinuity_m = 0.3;
  config.on_wall_m = 0.0;
  config.join_contiguous = true;
  config.contiguous_m = 0.55;
  config.join_alternate = true;
  config.alternate_behind_only = false;
  config.alternate_large_only = false;
  config.alternate_m = 0.55;
  config.drop_small = true;
  config.min_group_points = 2;
  config.join_again = false;
  config.join_hidden_zones = true;
  config.site_spacing_m = 0.0;
  config.node_merge_m = 0.15;
  config.min_branch_m = 0.2;
  config.virtual_half_width_m = 0.6;
  return config;
}

VoronoiConfig thesis_splitting_alone() {
  VoronoiConfig config = thesis_voronoi();
  config.join_contiguous = false;
  config.join_alternate = false;
  config.drop_small = false;
  config.join_hidden_zones = false;
  return config;
}

}  // namespace topogeo::voronoi
