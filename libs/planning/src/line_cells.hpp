// The cells of drawn lines.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

struct LineCells {
  std::vector<Cell> open;   ///< of openings and doors
  std::vector<Cell> walls;  ///< of walls, without open cells
};

/// All lie inside of the grid; a cell may be repeated.
LineCells cells_of_lines(const GridFrame& frame, std::span<const DrawnLine> lines);

/// The cells from a to b (map frame, different points), extended beyond both ends so that an
/// inexactly drawn line still splits the floor.
std::vector<Cell> cells_across(const GridFrame& frame, const Eigen::Vector2d& a_m,
                               const Eigen::Vector2d& b_m, double beyond_m);

}  // namespace topogeo::planning
