// Settings of route planning on nodes and branches.
#pragma once

namespace topogeo::planning {

struct PlanningConfig {
  double max_snap_m = 3.0;       ///< farthest that start and goal may lie from a branch, >= 0
  double min_clearance_m = 0.3;  ///< the robot's radius with a margin: a branch is closed where its
                                 ///< clearance is less, unless it is virtual, >= 0. B21:
                                 ///< 0.2625 m.
};

/// Throws std::invalid_argument naming the field, the value and the allowed range.
void check(const PlanningConfig& config);

}  // namespace topogeo::planning
