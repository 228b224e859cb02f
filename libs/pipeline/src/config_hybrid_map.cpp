#include "config_hybrid_map.hpp"

namespace topogeo::pipeline {

void describe_hybrid_map(HybridMapConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_map.resolution_m", &config.grid.resolution_m, 0.02, 1.0, "m",
             "side of a cell of the grid; a drawn grid keeps its own");
  schema.add("hybrid_map.margin_m", &config.grid.margin_m, 0.0, 100.0, "m",
             "unknown cells around what scans saw");
  schema.add("hybrid_map.hit", &config.grid.hit, 1, 1000, "",
             "log-odds in hundredths that a beam adds where it ends");
  schema.add("hybrid_map.miss", &config.grid.miss, 1, 1000, "",
             "the same that it takes off where it passes; larger: what went away is sooner free");
  schema.add("hybrid_map.limit", &config.grid.limit, 1, 10000, "",
             "the same, at most; smaller: what has changed is sooner believed");
  schema.add("hybrid_map.forbidden_cells", &config.inflation.forbidden_cells, 0.0, 100.0, "cells",
             "the robot's middle keeps further from occupied cells: its radius and a margin");
  schema.add("hybrid_map.inflate_unknown", &config.inflation.inflate_unknown,
             "the same from unknown cells; safer where tables and glass are, but keeps out of the "
             "edges of what was seen");
  schema.add("hybrid_map.min_zone_m2", &config.zones.min_area_m2, 0.0, 1000.0, "m2",
             "smaller zones that nobody drew join a neighbour");
  schema.add("hybrid_map.passage_half_width_m", &config.zones.passage_half_width_m, 0.05, 5.0, "m",
             "without drawn zones and passages of a map, zones meet where less is free");
  schema.add("hybrid_map.cut_reach_m", &config.zones.cut_reach_m, 0.0, 5.0, "m",
             "how much further than the clearance of a passage the border across it may reach");
}

void describe_hybrid_planner(planning::HybridPlannerConfig& config, support::ConfigSchema& schema) {
  schema.add(
      "hybrid_planner.start_snap_m", &config.start_snap_m, 0.0, 5.0, "m",
      "a robot in a forbidden cell starts from a passable one that is this near: it may have "
      "come so close to an obstacle");
  schema.add("hybrid_planner.goal_snap_m", &config.goal_snap_m, 0.0, 5.0, "m",
             "the same for goals; 0: a goal that is not free is refused");
  schema.add("hybrid_planner.exact_window_cells", &config.exact_window_cells, 0.0, 1e8, "cells",
             "routes that fit in a window of so many are planned again on the grid, as borders lie "
             "off the shortest way; 0: never, as the source");
  schema.add("hybrid_planner.piece_m", &config.piece_m, 0.0, 50.0, "m",
             "longer routes are planned again in pieces of this length; 0: never, as the source");
}

}  // namespace topogeo::pipeline
