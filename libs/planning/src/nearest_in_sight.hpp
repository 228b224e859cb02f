// The first open cell for a robot that stands on forbidden floor.
#pragma once

#include <optional>

#include "topogeo/planning/grid_search.hpp"

#include "cell_line.hpp"

namespace topogeo::planning {

/// The cell with `open` whose centre is nearest to a point of the grid, at most `within_m` from it
/// and visible: `clear` holds for all cells of the grid on the straight line, including both ends.
/// The first one, row by row, breaks ties.
template <typename Open, typename Clear>
std::optional<Cell> nearest_in_sight(const GridFrame& frame, const Eigen::Vector2d& point_m,
                                     double within_m, const Open& open, const Clear& clear) {
  const Cell cell = frame.cell_of(point_m).value();
  const auto reach = static_cast<std::int32_t>(within_m / frame.resolution_m) + 1;
  const CellBox box = grown({cell, cell}, reach, frame);
  std::optional<Cell> best;
  double best_m = within_m;
  for (std::int32_t row = box.low.row; row <= box.high.row; ++row) {
    for (std::int32_t column = box.low.column; column <= box.high.column; ++column) {
      const Cell candidate{column, row};
      const Eigen::Vector2d middle_m = frame.center_m(candidate);
      const double distance_m = (middle_m - point_m).norm();
      if (!open(candidate) || distance_m > best_m || (best && distance_m == best_m)) continue;
      const bool seen = visit_line(frame.in_cells(point_m), frame.in_cells(middle_m),
                                   [&](const Cell& c) { return frame.contains(c) && clear(c); });
      if (!seen) continue;
      best = candidate;
      best_m = distance_m;
    }
  }
  return best;
}

}  // namespace topogeo::planning
