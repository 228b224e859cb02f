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
  std::vector<Cell> walls;  ///< of walls, without those that are open
};

/// All inside of the grid; a cell may come more than once.
LineCells cells_of_lines(const GridFrame& frame, std::span<const DrawnLine> lines);

/// The cells from a to b (map frame, not the same) and so far beyond both, so that a line parts the
/// floor although it is not drawn to the centimetre.
std::vector<Cell> cells_across(const GridFrame& frame, const Eigen::Vector2d& a_m,
                               const Eigen::Vector2d& b_m, double beyond_m);

}  // namespace topogeo::planning
