#include "topogeo/planning/planning_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::planning {

void describe(PlannerConfig& config, support::ConfigSchema& schema) {
  schema.add("planner.on", &config.on,
             {{"hybrid", PlanFirstOn::kHybrid}, {"graph", PlanFirstOn::kGraph}},
             "hybrid: the shortest routes, on grid and zones; graph: routes along branches, as far "
             "from walls as possible; if one has no route, the other one plans it");
}

void describe(PlanningConfig& config, support::ConfigSchema& schema) {
  schema.add("planning.max_snap_m", &config.max_snap_m, 0.0, 100.0, "m",
             "largest distance of start and goal from a branch");
  schema.add("planning.min_clearance_m", &config.min_clearance_m, 0.0, 10.0, "m",
             "smallest clearance of a route: radius of the robot plus a margin");
}

void check(const PlanningConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::planning
