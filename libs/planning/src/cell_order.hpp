// Sets of cells as sorted vectors.
#pragma once

#include <algorithm>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Order by row, then column, like the cell numbers of a grid.
inline bool comes_before(const Cell& a, const Cell& b) {
  return a.row != b.row ? a.row < b.row : a.column < b.column;
}

/// Sorts and drops duplicates.
inline void sort_cells(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end(), comes_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/// `sorted`: the result of sort_cells.
inline bool has_cell(const std::vector<Cell>& sorted, const Cell& cell) {
  return std::binary_search(sorted.begin(), sorted.end(), cell, comes_before);
}

}  // namespace topogeo::planning
