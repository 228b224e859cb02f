// The floor that a route along branches is driven on.
//
// Such a route may lead where the map's grid has no room, or where there is no grid: then the
// branches count. What the laser sees keeps the robot off the walls all the same.
#pragma once

#include <memory>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/free_space.hpp"

namespace topogeo::navigation {

/// Whether a part of it follows a branch.
bool on_branches(const RoutePlan& route);

/// `space` with the cells free that are in the circles of clearance of the route's branches, as far
/// as a body reaches, and passable where the route leads off the grid. Null: there is no map;
/// everything around the route is free. The route has parts and clearances.
std::shared_ptr<const planning::FreeSpace> floor_of(const RoutePlan& route,
                                                    const planning::FreeSpace* space);

}  // namespace topogeo::navigation
