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
  schema.add("hybrid_map.narrowing_ratio", &config.rooms.narrowing_ratio, 0.0, 1.0, "",
             "rooms meet where less is free than this part of the narrower of the two");
  schema.add("hybrid_map.door_ratio", &config.rooms.door_ratio, 0.0, 1.0, "",
             "the same where the graph of the map has a door or a narrowing");
  schema.add("hybrid_map.opening_ratio", &config.rooms.opening_ratio, 0.0, 1.0, "",
             "and where less is free than this part of the wider one: a corridor ends at a hall");
  schema.add("hybrid_map.nook_depth", &config.rooms.nook_depth, 0.0, 100.0, "",
             "what is open by its width squared times this is part of the room that it opens to");
  schema.add("hybrid_map.column_m", &config.rooms.column_m, 0.0, 100.0, "m",
             "what stands free and is shorter parts no rooms");
  schema.add("hybrid_map.furniture_from_m", &config.rooms.furniture_from_m, 0.0, 100.0, "m",
             "nor does what stands free and is thicker than that by half of its area, as a rack");
  schema.add("hybrid_map.furniture_to_m", &config.rooms.furniture_to_m, 0.0, 100.0, "m",
             "and at most so thick: blocks of rooms are thicker");
}

void check(const ScanGridConfig& config) {
  support::check_ranges(config);
  support::require_between("snap_cells", config.snap_cells, 1, 1024, "cells");
}

void check(const InflationConfig& config) {
  constexpr double kMostPocket_m2 = 1e6;  // larger than any floor
  support::check_ranges(config);
  support::require_between("min_pocket_m2", config.min_pocket_m2, 0.0, kMostPocket_m2, "m2");
}

void check(const ZoneConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::planning
