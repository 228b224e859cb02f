// The floor for a route along branches.
//
// Such a route may lead where the map's grid has no room, or where there is no grid; then the
// branches count. The laser still keeps the robot off the walls.
#pragma once

#include <memory>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/free_space.hpp"

namespace topogeo::navigation {

/// Whether a part of it follows a branch.
bool on_branches(const RoutePlan& route);

/// `space` with all cells free that lie in the circles of clearance of the route's branches, up to
/// the size of a body, and passable where the route leaves the grid. Null: there is no map, and
/// everything around the route is free. The route has parts and clearances.
std::shared_ptr<const planning::FreeSpace> floor_of(const RoutePlan& route,
                                                    const planning::FreeSpace* space);

}  // namespace topogeo::navigation
