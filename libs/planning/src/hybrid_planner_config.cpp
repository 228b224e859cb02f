#include "topogeo/planning/hybrid_planner_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::planning {

void describe(HybridPlannerConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_planner.start_snap_m", &config.start_snap_m, 0.0, 5.0, "m",
             "a robot in a forbidden cell, for example close to an obstacle, starts from a "
             "passable cell within this distance if no obstacle is between");
  schema.add("hybrid_planner.goal_snap_m", &config.goal_snap_m, 0.0, 5.0, "m",
             "the same distance for goals; 0: a goal that is not free is refused");
  schema.add("hybrid_planner.exact_window_cells", &config.exact_window_cells, 0.0, 1e8, "cells",
             "routes within a window of at most this many cells are planned again on the grid, "
             "because zone borders lie off the shortest path; 0: never, as in MACONDO");
  schema.add("hybrid_planner.piece_m", &config.piece_m, 0.0, 50.0, "m",
             "longer routes are planned again in pieces of this length; 0: never, as in MACONDO");
}

void check(const HybridPlannerConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::planning
