#include "topogeo/planning/planning_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::planning {

void describe(PlannerConfig& config, support::ConfigSchema& schema) {
  schema.add("planner.on", &config.on,
             {{"hybrid", PlanFirstOn::kHybrid}, {"graph", PlanFirstOn::kGraph}},
             "hybrid: the shortest routes, on grid and zones; graph: along branches, as far from "
             "walls as can be; the other one is asked where there is no route");
}

void describe(PlanningConfig& config, support::ConfigSchema& schema) {
  schema.add("planning.max_snap_m", &config.max_snap_m, 0.0, 100.0, "m",
             "farthest that start and goal may lie from a branch");
  schema.add("planning.min_clearance_m", &config.min_clearance_m, 0.0, 10.0, "m",
             "radius of the robot with a margin");
}

void check(const PlanningConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::planning
