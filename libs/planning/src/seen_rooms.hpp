// Whether a laser has seen enough of a room to name it.
#pragma once

#include <vector>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/room_memory.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// One value for each zone: false for stripes seen through doors and rooms seen in part, whose
/// outline is mostly floor next to unknown cells. A room that the robot was in needs less outline.
std::vector<bool> zones_seen_well(const FreeSpace& space, const StopPoses& poses,
                                  const ZoneMap& zones);

}  // namespace topogeo::planning
