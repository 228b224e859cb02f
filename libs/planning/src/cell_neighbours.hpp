// The cells beside a cell.
#pragma once

#include <cstddef>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Calls `visit` with the indices of the up to four cells that share a side with one.
template <typename Visit>
void visit_neighbours(const GridFrame& frame, std::size_t index, Visit&& visit) {
  const Cell cell = frame.cell_at(index);
  const auto width = static_cast<std::size_t>(frame.columns);
  if (cell.column + 1 < frame.columns) visit(index + 1);
  if (cell.row + 1 < frame.rows) visit(index + width);
  if (cell.column > 0) visit(index - 1);
  if (cell.row > 0) visit(index - width);
}

}  // namespace topogeo::planning
