// Looking around on an occupancy grid.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
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

std::optional<planning::Cell> nearest_passable(const planning::FreeSpace& space,
                                               const Eigen::Vector2d& point_m, double reach_m);

/// Whether no occupied cell lies on the straight line between two points of the map frame.
bool nothing_between(const planning::OccupancyGrid& grid, const Eigen::Vector2d& a_m,
                     const Eigen::Vector2d& b_m);

/// Whether one of the four cells beside it is unknown; cells beyond the grid are.
bool beside_unknown(const planning::OccupancyGrid& grid, const planning::Cell& cell);

/// Whether an unknown cell of the grid is at most `reach_m` away.
bool any_unknown(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                 double reach_m);

/// Whether a free cell beside an unknown one is at most `reach_m` away.
bool unknown_near(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                  double reach_m);

/// From a point to the mean of the unknown cells at most `reach_m` away; (1, 0) without any.
Eigen::Vector2d toward_unknown(const planning::OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                               double reach_m);

}  // namespace topogeo::navigation
