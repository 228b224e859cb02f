#include "topogeo/planning/grid_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::planning {

void describe(ScanGridConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_map.resolution_m", &config.resolution_m, 0.02, 1.0, "m",
             "side of a cell of the grid; a drawn grid keeps its own");
  schema.add("hybrid_map.margin_m", &config.margin_m, 0.0, 100.0, "m",
             "unknown cells around what scans saw");
  schema.add("hybrid_map.hit", &config.hit, 1, 1000, "",
             "log-odds in hundredths that a beam adds where it ends");
  schema.add("hybrid_map.miss", &config.miss, 1, 1000, "",
             "the same that it takes off where it passes; larger: what went away is sooner free");
  schema.add("hybrid_map.limit", &config.limit, 1, 10000, "",
             "the same, at most; smaller: what has changed, as a door shut later, is sooner "
             "accepted");
}

void describe(InflationConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_map.forbidden_cells", &config.forbidden_cells, 0.0, 100.0, "cells",
             "the robot's middle keeps further from occupied cells: its radius and a margin");
  schema.add("hybrid_map.inflate_unknown", &config.inflate_unknown,
             "the same from unknown cells; safer where tables and glass are, but keeps out of the "
             "edges of what was seen");
}

void describe(ZoneConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_map.min_zone_m2", &config.min_area_m2, 0.0, 1000.0, "m2",
             "smaller zones that were not drawn join the neighbour with the longest border");
  schema.add("hybrid_map.passage_half_width_m", &config.passage_half_width_m, 0.05, 5.0, "m",
             "without drawn zones and passages of a map, zones meet where less is free");
  schema.add("hybrid_map.cut_reach_m", &config.cut_reach_m, 0.0, 5.0, "m",
             "how much further than the clearance of a passage the border across it may reach");
}

void check(const ScanGridConfig& config) {
  support::check_ranges(config);
  support::require_between("snap_cells", config.snap_cells, 1, 1024, "cells");
}

void check(const InflationConfig& config) {
  support::check_ranges(config);
}

void check(const ZoneConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::planning
