// Merges basins of clearance into rooms.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/planning/grid_config.hpp"

#include "clearance_basins.hpp"

namespace topogeo::planning {

/// The room of each basin, as the index of one of its basins. Two are merged if the place between
/// them is nearly as wide as the narrower of the two (narrowing_ratio; door_ratio where the map has
/// a door, `doors` by saddle) and not much narrower than the wider one (opening_ratio): a corridor
/// ends at a hall although its mouth is as wide as the corridor. The widest places, relative to the
/// rooms that they join, come first. Then nooks (nook_depth), the smallest first, are merged into
/// the room that they open to. `cell_m`: side of a cell.
std::vector<std::uint32_t> rooms_of(const Basins& basins, const std::vector<bool>& doors,
                                    const RoomConfig& config, double cell_m);

}  // namespace topogeo::planning
