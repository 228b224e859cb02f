// Finding the cells that a route begins and ends at, and saying why there is none.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "topogeo/planning/hybrid_planner.hpp"

namespace topogeo::planning {

/// "(1.00, 2.50)"
std::string shown(const Eigen::Vector2d& point_m);

/// A route that there is not.
HybridRoute no_route(RouteStatus status, std::string reason);

/// The passable cell of a point, or the nearest one within snap_m that no obstacle hides. Without
/// any, `failure` gets status and reason of a route that begins (`what` is "start") or ends there.
std::optional<Cell> find_end(const FreeSpace& space, const Eigen::Vector2d& point_m, double snap_m,
                             bool is_start, HybridRoute& failure);

/// Middle of the cell nearest to a point of all those that `reachable` holds for (by index); of
/// equally near ones the first.
std::optional<Eigen::Vector2d> nearest_cell_m(const GridFrame& frame,
                                              const Eigen::Vector2d& point_m,
                                              const std::function<bool(std::size_t)>& reachable);

/// Cost, clearance, points and length of a route from its cells.
void fill_in(const FreeSpace& space, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
             HybridRoute& route);

}  // namespace topogeo::planning
