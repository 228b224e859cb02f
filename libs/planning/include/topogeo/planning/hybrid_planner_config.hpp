// Settings of route planning on grid and zones.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

struct HybridPlannerConfig {
  double start_snap_m = 0.5;
  double goal_snap_m = 0.0;
  /// A route longer than the straight line is planned again as a whole if all shorter paths lie in
  /// a window of at most this many cells.
  double exact_window_cells = 40000.0;
  double piece_m = 10.0;  ///< of the half-overlapping pieces of other routes
};

/// Declares the section `hybrid_planner`.
void describe(HybridPlannerConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const HybridPlannerConfig& config);

}  // namespace topogeo::planning
