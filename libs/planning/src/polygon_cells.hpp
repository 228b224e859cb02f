// The cells of a polygon.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Even-odd rule: whether a ray to the right crosses the outline an odd number of times.
inline bool inside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point) {
  bool odd = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[j];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) odd = !odd;
  }
  return odd;
}

/// Calls `visit(cell)` for each cell of the grid whose middle lies in the polygon, row by row.
template <typename Visit>
void visit_cells_in(const GridFrame& frame, const std::vector<Eigen::Vector2d>& polygon_m,
                    Visit&& visit) {
  std::vector<Eigen::Vector2d> polygon;
  Eigen::Vector2d low(frame.columns, frame.rows);
  Eigen::Vector2d high(0.0, 0.0);
  for (const Eigen::Vector2d& corner_m : polygon_m) {
    polygon.push_back(frame.in_cells(corner_m));
    low = low.cwiseMin(polygon.back());
    high = high.cwiseMax(polygon.back());
  }
  low = low.cwiseMax(Eigen::Vector2d::Zero());
  high = high.cwiseMin(Eigen::Vector2d(frame.columns - 1, frame.rows - 1));
  for (auto row = static_cast<std::int32_t>(low.y()); row <= high.y(); ++row) {
    for (auto column = static_cast<std::int32_t>(low.x()); column <= high.x(); ++column) {
      if (inside(polygon, {column + 0.5, row + 0.5})) visit(Cell{column, row});
    }
  }
}

}  // namespace topogeo::planning
