// The cells that a straight line passes through.
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include <Eigen/Core>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Calls `visit(cell)` for each cell on the line from a to b (coordinates in cells), in order,
/// including both ends (Amanatides and Woo 1987). If the line passes through a corner of cells,
/// visits both cells beside it, so that walls have no gaps and no line of sight passes between two
/// obstacles. Stops when `visit` returns false; returns whether none did.
template <typename Visit>
bool visit_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Visit&& visit) {
  constexpr double kCorner = 1e-9;
  Cell cell{static_cast<std::int32_t>(std::floor(a.x())),
            static_cast<std::int32_t>(std::floor(a.y()))};
  const Cell end{static_cast<std::int32_t>(std::floor(b.x())),
                 static_cast<std::int32_t>(std::floor(b.y()))};
  std::int32_t left_x = std::abs(end.column - cell.column);
  std::int32_t left_y = std::abs(end.row - cell.row);
  const std::int32_t step_x = end.column > cell.column ? 1 : -1;
  const std::int32_t step_y = end.row > cell.row ? 1 : -1;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double delta_x = left_x > 0 ? std::fabs(1.0 / (b.x() - a.x())) : kNever;
  const double delta_y = left_y > 0 ? std::fabs(1.0 / (b.y() - a.y())) : kNever;
  // Share of the line at the next border between columns and between rows.
  double next_x =
      left_x > 0 ? (cell.column + (step_x > 0 ? 1 : 0) - a.x()) / (b.x() - a.x()) : kNever;
  double next_y = left_y > 0 ? (cell.row + (step_y > 0 ? 1 : 0) - a.y()) / (b.y() - a.y()) : kNever;
  if (!visit(cell)) return false;
  while (left_x > 0 || left_y > 0) {
    const bool corner = left_x > 0 && left_y > 0 && std::fabs(next_x - next_y) < kCorner;
    if (corner && (!visit(Cell{cell.column + step_x, cell.row}) ||
                   !visit(Cell{cell.column, cell.row + step_y}))) {
      return false;
    }
    const bool along_x = left_y == 0 || (left_x > 0 && next_x < next_y);
    if (corner || along_x) {
      cell.column += step_x;
      next_x += delta_x;
      --left_x;
    }
    if (corner || !along_x) {
      cell.row += step_y;
      next_y += delta_y;
      --left_y;
    }
    if (!visit(cell)) return false;
  }
  return true;
}

}  // namespace topogeo::planning
