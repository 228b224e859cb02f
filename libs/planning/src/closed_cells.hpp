// Cells with present obstacles that are not on the map, and the forbidden cells around them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/grid_search.hpp"

namespace topogeo::planning {

class ClosedCells {
 public:
  /// `filled`: in any order, with repetitions, also outside of the grid. `space` must outlive it.
  ClosedCells(const FreeSpace& space, std::span<const Cell> filled);

  /// Whether `forbids` holds for no cell.
  [[nodiscard]] bool empty() const { return forbidden_.empty(); }

  /// Whether an unmapped obstacle is in the cell.
  [[nodiscard]] bool filled(const Cell& cell) const;

  /// Whether an unmapped obstacle keeps the robot's centre out of the cell, although the space
  /// alone would allow it.
  [[nodiscard]] bool forbids(const Cell& cell) const;

  /// The cells that `forbids` holds for, row by row.
  [[nodiscard]] const std::vector<Cell>& forbidden() const { return forbidden_; }

  void close_in(SearchWindow& window) const;

  /// Like FreeSpace::clearance_m, with the filled cells as obstacles.
  [[nodiscard]] double clearance_m(const Cell& cell) const;

 private:
  const FreeSpace& space_;
  std::vector<Cell> filled_;     // row by row
  std::vector<Cell> forbidden_;  // row by row
};

}  // namespace topogeo::planning
