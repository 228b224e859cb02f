// What stands free on a floor: columns, tables, racks. It parts no rooms.
#pragma once

#include "topogeo/planning/grid_config.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// The walls of a floor: free and occupied cells only. Unknown cells count as walls. What touches
/// no wall is free here when it is short (column_m), or when half of it lies deeper than a wall is
/// thick (furniture_from_m), none of it is thicker than furniture (furniture_to_m) and it is
/// compact: a wall between two doors stands free, too, but is thin, and a block of rooms is thick
/// or has corners.
OccupancyGrid without_furniture(const OccupancyGrid& grid, const RoomConfig& config);

}  // namespace topogeo::planning
