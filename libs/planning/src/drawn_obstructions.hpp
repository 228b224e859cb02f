// Drawn items that keep a robot from a place: the reasons of a refused goal or route.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"

#include "closed_cells.hpp"

namespace topogeo::planning {

/// Why the robot's centre may not be at a point of the grid, if a drawn item is the reason: "is in
/// the no-go zone 'stairs'", "is 0.20 m from a drawn wall: too near". Empty if the map itself is,
/// or nothing.
std::optional<std::string> drawn_obstruction(const FreeSpace& space,
                                             const Eigen::Vector2d& point_m);

/// The drawn items that separate two cells, as text in the order of the path that breaks the
/// fewest rules: "'stairs'", "a drawn wall". Empty if no path leads there without the drawing
/// either. Cells that `closed` forbids stay closed. Searches the whole grid (Dijkstra).
std::vector<std::string> drawn_items_between(const FreeSpace& space, const ClosedCells& closed,
                                             const Cell& from, const Cell& to);

/// "'a' is in the way", "'a', 'b' and 'c' are in the way".
std::string in_the_way(const std::vector<std::string>& items);

}  // namespace topogeo::planning
