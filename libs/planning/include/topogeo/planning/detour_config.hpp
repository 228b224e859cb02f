// Settings of detours around obstacles.
#pragma once

namespace topogeo::planning {

struct DetourConfig {
  double half_side_m = 3.0;   ///< of the window around the robot, [0.5, 20]
  double start_snap_m = 0.5;  ///< as HybridPlannerConfig::start_snap_m: obstacles seen now can be
                              ///< nearer than the forbidden cells, [0, 5]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const DetourConfig& config);

}  // namespace topogeo::planning
