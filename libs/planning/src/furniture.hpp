// Removes freestanding furniture (columns, tables, racks), which does not separate rooms.
#pragma once

#include "topogeo/planning/grid_config.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// The walls of a floor: free and occupied cells only. Unknown cells count as walls. A block away
/// from the grid's edge becomes free if it is short (column_m), or if half of it lies deeper than a
/// wall is thick (furniture_from_m), none of it is thicker than furniture (furniture_to_m) and it
/// is compact. A wall between two doors is freestanding, too, but thin, and a block of rooms is
/// thick or has corners.
OccupancyGrid without_furniture(const OccupancyGrid& grid, const RoomConfig& config);

}  // namespace topogeo::planning
