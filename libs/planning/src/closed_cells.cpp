#include "closed_cells.hpp"

#include <algorithm>
#include <cmath>

#include "cell_order.hpp"

namespace topogeo::planning {

ClosedCells::ClosedCells(const FreeSpace& space, std::span<const Cell> filled)
    : space_(space), filled_(filled.begin(), filled.end()) {
  sort_cells(filled_);
  const double radius = space.inflation().forbidden_cells;
  const auto reach = static_cast<std::int32_t>(radius);
  for (const Cell& cell : filled_) {
    for (std::int32_t y = -reach; y <= reach; ++y) {
      for (std::int32_t x = -reach; x <= reach; ++x) {
        const Cell near{cell.column + x, cell.row + y};
        if (x * x + y * y <= radius * radius && space.passable(near)) forbidden_.push_back(near);
      }
    }
  }
  sort_cells(forbidden_);
}

bool ClosedCells::filled(const Cell& cell) const {
  return has_cell(filled_, cell);
}

bool ClosedCells::forbids(const Cell& cell) const {
  return has_cell(forbidden_, cell);
}

void ClosedCells::close_in(SearchWindow& window) const {
  for (const Cell& cell : forbidden_) window.close(cell);
}

double ClosedCells::clearance_m(const Cell& cell) const {
  double nearest2 = HUGE_VAL;  // squared, in cells
  for (const Cell& other : filled_) {
    const double across = other.column - cell.column;
    const double up = other.row - cell.row;
    nearest2 = std::min(nearest2, across * across + up * up);
  }
  return std::min(space_.clearance_m(cell), std::sqrt(nearest2) * space_.frame().resolution_m);
}

}  // namespace topogeo::planning
