// Visibility and distance queries on an occupancy grid.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::navigation {

/// The nearest cell to a point for which `good` holds, at most `reach_m` away.
std::optional<planning::Cell> nearest_cell(const planning::GridFrame& frame,
                                           const Eigen::Vector2d& point_m, double reach_m,
                                           const std::function<bool(const planning::Cell&)>& good);

/// Like nearest_cell, but with the least cost of the cell's middle.
std::optional<planning::Cell> best_cell(const planning::GridFrame& frame,
                                        const Eigen::Vector2d& point_m, double reach_m,
                                        const std::function<bool(const planning::Cell&)>& good,
                                        const std::function<double(const Eigen::Vector2d&)>& cost);

/// Whether each zone can be reached from a point, by index. If the robot must not be at the point,
/// or is shut in, counts zones reachable from any passable cell that it sees within 0.5 m; none
/// without such a cell.
std::vector<bool> reachable_zones(const planning::HybridMap& map, const Eigen::Vector2d& from_m);

/// Whether no occupied cell lies on the straight line between two points of the map frame.
bool nothing_between(const planning::OccupancyGrid& grid, const Eigen::Vector2d& a_m,
                     const Eigen::Vector2d& b_m);

/// Whether an unknown cell of the grid is at most `reach_m` away.
bool any_unknown(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                 double reach_m);

/// Direction from a point to the mean of the unknown cells within `reach_m`; (1, 0) without any.
Eigen::Vector2d toward_unknown(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                               double reach_m);

}  // namespace topogeo::navigation
