// Drawn rooms, combined with the rooms found between the walls.
#pragma once

#include <span>

#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// A zone for each polygon like drawn_zones, and the rooms of zones_of_rooms in the free space
/// outside of all polygons, so a drawn room does not change the others.
ZoneMap zones_of_drawn_and_found_rooms(const FreeSpace& space, std::span<const DrawnZone> drawn,
                                       std::span<const Passage> passages = {},
                                       const ZoneConfig& config = {});

}  // namespace topogeo::planning
