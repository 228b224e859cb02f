// Sets of cells as sorted vectors.
#pragma once

#include <algorithm>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Row by row, as the cells of a grid are numbered.
inline bool comes_before(const Cell& a, const Cell& b) {
  return a.row != b.row ? a.row < b.row : a.column < b.column;
}

/// Sorts and drops what comes twice.
inline void sort_cells(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end(), comes_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/// `sorted` as sort_cells leaves it.
inline bool has_cell(const std::vector<Cell>& sorted, const Cell& cell) {
  return std::binary_search(sorted.begin(), sorted.end(), cell, comes_before);
}

}  // namespace topogeo::planning
