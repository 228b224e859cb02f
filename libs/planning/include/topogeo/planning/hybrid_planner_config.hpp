// Settings of route planning on grid and zones.
#pragma once

namespace topogeo::planning {

struct HybridPlannerConfig {
  /// A robot that stands in a forbidden cell starts from the nearest passable one this near, if no
  /// obstacle is between, [0, 5].
  double start_snap_m = 0.5;
  double goal_snap_m = 0.0;  ///< the same for goals, [0, 5]; 0: they must be passable
  /// A route that is longer than the straight line is planned again whole when all shorter paths
  /// lie in a window of at most so many cells, [0, 1e8]; 0: never, as in MACONDO.
  double exact_window_cells = 40000.0;
  /// Other routes are planned again in pieces of this length that overlap by half, [0, 50]; 0:
  /// never, as in MACONDO.
  double piece_m = 10.0;
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const HybridPlannerConfig& config);

}  // namespace topogeo::planning
