#include "topogeo/planning/grid_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::planning {

void describe(ScanGridConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_map.resolution_m", &config.resolution_m, 0.02, 1.0, "m",
             "side of a grid cell; a drawn grid keeps its own resolution");
  schema.add("hybrid_map.margin_m", &config.margin_m, 0.0, 100.0, "m",
             "margin of unknown cells around the area that scans saw");
  schema.add("hybrid_map.hit", &config.hit, 1, 1000, "",
             "log-odds in hundredths that a beam adds to the cell where it ends");
  schema.add("hybrid_map.miss", &config.miss, 1, 1000, "",
             "log-odds in hundredths that a beam subtracts from each cell that it passes; larger: "
             "removed obstacles become free sooner");
  schema.add("hybrid_map.limit", &config.limit, 1, 10000, "",
             "largest log-odds in hundredths; smaller: changes such as a door shut later are "
             "accepted sooner");
  schema.fix({"hybrid_map.hit", "hybrid_map.miss", "hybrid_map.limit"});
}

void describe(InflationConfig& config, support::ConfigSchema& schema) {
  schema.add(
      "hybrid_map.forbidden_cells", &config.forbidden_cells, 0.0, 100.0, "cells",
      "smallest distance of the robot's centre from occupied cells: its radius plus a margin");
  schema.add("hybrid_map.inflate_unknown", &config.inflate_unknown,
             "applies that distance to unknown cells as well; safer near tables and glass, but it "
             "closes the edges of the area that scans saw");
}

void describe(ZoneConfig& config, support::ConfigSchema& schema) {
  schema.add("hybrid_map.min_zone_m2", &config.min_area_m2, 0.0, 1000.0, "m2",
             "smaller zones that were not drawn join the neighbour with the longest common border");
  schema.add("hybrid_map.narrowing_ratio", &config.rooms.narrowing_ratio, 0.0, 1.0, "",
             "two rooms are separate if the opening between them is narrower than this part of the "
             "narrower room");
  schema.add("hybrid_map.door_ratio", &config.rooms.door_ratio, 0.0, 1.0, "",
             "the same ratio where the graph of the map has a door or a narrowing");
  schema.add("hybrid_map.opening_ratio", &config.rooms.opening_ratio, 0.0, 1.0, "",
             "two rooms are also separate if the opening is narrower than this part of the wider "
             "room, as where a corridor ends at a hall");
  schema.add("hybrid_map.nook_depth", &config.rooms.nook_depth, 0.0, 100.0, "",
             "a nook smaller than this times the squared width of its opening is part of the room "
             "that it opens to");
  schema.add("hybrid_map.column_m", &config.rooms.column_m, 0.0, 100.0, "m",
             "free-standing obstacles up to this length separate no rooms");
  schema.add("hybrid_map.furniture_from_m", &config.rooms.furniture_from_m, 0.0, 100.0, "m",
             "free-standing obstacles separate no rooms either if half of their area is thicker "
             "than this, as in a rack");
  schema.add("hybrid_map.furniture_to_m", &config.rooms.furniture_to_m, 0.0, 100.0, "m",
             "largest thickness of such obstacles; blocks of rooms are thicker");
  schema.fix({"hybrid_map.narrowing_ratio", "hybrid_map.door_ratio", "hybrid_map.opening_ratio",
              "hybrid_map.nook_depth"});
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
