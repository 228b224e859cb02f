// Joins the parts of a graph that was made of a grid, where the free space joins them.
#pragma once

#include <span>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

/// Adds a node at each of `places_m` that is more than 6 m from the graph along the free space, in
/// their order: a room that no branch leads to. Then adds a branch along the free space
/// from each part to the nearest other one, until no two parts have a free path between them. The
/// branches keep to the middle of the free space and have its clearances; where one meets another
/// between its ends, a node is added. The positions of nodes and branches must be inside the grid.
void link_parts(topomap::GlobalMap& map, const planning::FreeSpace& space,
                std::span<const Eigen::Vector2d> places_m);

}  // namespace topogeo::exchange
