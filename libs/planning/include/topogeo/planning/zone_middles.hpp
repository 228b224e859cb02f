// Goals in rooms: the middle of each zone, away from walls and doors.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// For each of the first `zones` zones a cell of it: among those at least 1 m inside its outline,
/// or 70 % of the largest distance in smaller zones, the one nearest to the centroid. Nothing for
/// a zone without cells. `zone_of_cell`: one value for each cell of the frame, row by row.
std::vector<std::optional<Cell>> middles_of_zones(const GridFrame& frame,
                                                  std::span<const ZoneId> zone_of_cell,
                                                  std::size_t zones);

}  // namespace topogeo::planning
