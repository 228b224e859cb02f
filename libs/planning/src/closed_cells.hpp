// Cells that something fills now which is not on the map, and the forbidden cells round them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/grid_search.hpp"

namespace topogeo::planning {

class ClosedCells {
 public:
  /// `filled`: in any order, also twice, also outside of the grid. `space` must outlive it.
  ClosedCells(const FreeSpace& space, std::span<const Cell> filled);

  /// Whether `forbids` holds for no cell.
  [[nodiscard]] bool empty() const { return forbidden_.empty(); }

  /// Whether something fills the cell.
  [[nodiscard]] bool filled(const Cell& cell) const;

  /// Whether the robot's middle must keep out of the cell because of what is not on the map, though
  /// the space alone would let it in.
  [[nodiscard]] bool forbids(const Cell& cell) const;

  /// The cells that `forbids` holds for, row by row.
  [[nodiscard]] const std::vector<Cell>& forbidden() const { return forbidden_; }

  void close_in(SearchWindow& window) const;

  /// As FreeSpace::clearance_m, with the filled cells as obstacles.
  [[nodiscard]] double clearance_m(const Cell& cell) const;

 private:
  const FreeSpace& space_;
  std::vector<Cell> filled_;     // row by row
  std::vector<Cell> forbidden_;  // the same
};

}  // namespace topogeo::planning
