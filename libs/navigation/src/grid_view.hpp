// Looking around on an occupancy grid.
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

/// The cell of the grid nearest to a point for which `good` holds, at most `reach_m` away.
std::optional<planning::Cell> nearest_cell(const planning::GridFrame& frame,
                                           const Eigen::Vector2d& point_m, double reach_m,
                                           const std::function<bool(const planning::Cell&)>& good);

/// Of those cells the one whose middle has the least cost.
std::optional<planning::Cell> best_cell(const planning::GridFrame& frame,
                                        const Eigen::Vector2d& point_m, double reach_m,
                                        const std::function<bool(const planning::Cell&)>& good,
                                        const std::function<double(const Eigen::Vector2d&)>& cost);

/// Which zones can be got to from a point, by index; from one where a robot must not be, or is shut
/// in, those that can be got to from any passable cell that it sees within 0.5 m. None when there
/// is no such cell.
std::vector<bool> reachable_zones(const planning::HybridMap& map, const Eigen::Vector2d& from_m);

/// Whether no occupied cell lies on the straight line between two points of the map frame.
bool nothing_between(const planning::OccupancyGrid& grid, const Eigen::Vector2d& a_m,
                     const Eigen::Vector2d& b_m);

/// Whether an unknown cell of the grid is at most `reach_m` away.
bool any_unknown(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                 double reach_m);

/// From a point to the mean of the unknown cells at most `reach_m` away; (1, 0) without any.
Eigen::Vector2d toward_unknown(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                               double reach_m);

}  // namespace topogeo::navigation
