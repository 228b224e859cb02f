// Settings of route planning on grid and zones.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

struct HybridPlannerConfig {
  double start_snap_m = 0.5;
  double goal_snap_m = 0.0;
  /// A route that is longer than the straight line is planned again whole when all paths shorter
  /// than it lie in a window of at most so many cells.
  double exact_window_cells = 40000.0;
  double piece_m = 10.0;  ///< of the pieces, which overlap by half, of all other routes
};

/// Declares the section `hybrid_planner`.
void describe(HybridPlannerConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const HybridPlannerConfig& config);

}  // namespace topogeo::planning
