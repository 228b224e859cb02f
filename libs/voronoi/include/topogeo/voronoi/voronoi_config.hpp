// Settings of the local Voronoi diagram (Thesis, 4.2; docs/algorithms.md, "Local Voronoi diagram").
//
// Defaults maximise the share of real nodes that are found again in a scan half a metre away, on a
// simulated floor and three recorded logs together (docs/decisions/perception.md).
// Without eq. 4.9 the share is 0.74, with it as printed 0.75, with `alternate_behind_only` 0.77;
// with `join_hidden_zones` 0.58 of half as many nodes.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::voronoi {

struct VoronoiConfig {
  double range_limit_m = 10.0;
  double resolution_m = 0.05;
  bool window_of_groups = false;
  /// Direction of the robot's forward motion in the laser frame: defines left and right for hidden
  /// zones and virtual groups. Follows from the mounting of the laser.
  double forward_rad = 0.0;
  double dropout_rad = 0.035;

  bool split_discontinuities = true;
  double discontinuity_m = 0.5;
  double on_wall_m = 0.05;
  bool join_contiguous = true;
  double contiguous_m = 0.55;
  bool join_alternate = true;
  bool alternate_behind_only = true;
  bool alternate_large_only = true;
  double alternate_m = 0.55;
  bool drop_small = true;
  int min_group_points = 2;  ///< eq. 4.10 prints "fewer", its text "equal or below": the text holds
  bool join_again = true;
  bool join_hidden_zones = false;

  double site_spacing_m = 0.1;  ///< at most 99 sites between two readings

  double node_merge_m = 0.15;
  double min_branch_m = 0.2;

  double virtual_half_width_m = 0.6;
};

/// Declares the part of the section `local_map` for the diagram.
void describe(VoronoiConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const VoronoiConfig& config);

}  // namespace topogeo::voronoi
