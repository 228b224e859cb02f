#include "unknown_floor.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::navigation {

using planning::Cell;
using planning::CellState;

UnknownFloor::UnknownFloor(const planning::FreeSpace& space)
    : frame_(space.frame()), kinds_(space.frame().size(), Kind::kClosed) {
  planning::OccupancyGrid hoped = space.grid();
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    const Cell cell = frame_.cell_at(i);
    if (hoped.at(cell) == CellState::kUnknown) hoped.set(cell, CellState::kFree);
  }
  const planning::FreeSpace open(std::move(hoped), space.inflation());
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    if (!open.passable(i)) continue;
    const bool unknown = space.grid().at(frame_.cell_at(i)) == CellState::kUnknown;
    kinds_[i] = unknown ? Kind::kUnknown : Kind::kKnown;
  }
}

bool UnknownFloor::contains(const Cell& cell) const {
  return frame_.contains(cell) && kinds_[frame_.index(cell)] == Kind::kUnknown;
}

bool UnknownFloor::beside(const Cell& cell) const {
  constexpr std::array<Cell, 4> kBeside = {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}};
  for (const Cell& step : kBeside) {
    if (contains({cell.column + step.column, cell.row + step.row})) return true;
  }
  return false;
}

// Casts rays that are a cell apart at their ends, in steps of a cell; each step represents its
// piece of the disc. The start itself may be closed.
double UnknownFloor::ahead_m2(const Eigen::Vector2d& from_m, double near_m, double sight_m) const {
  const Eigen::Vector2d from = frame_.in_cells(from_m);
  const Cell here{static_cast<std::int32_t>(std::floor(from.x())),
                  static_cast<std::int32_t>(std::floor(from.y()))};
  const double near = near_m / frame_.resolution_m;
  const double sight = sight_m / frame_.resolution_m;
  const double rays = std::ceil(2.0 * std::numbers::pi * sight);
  const double apart_rad = 2.0 * std::numbers::pi / rays;
  double cells = 0.0;
  for (double ray = 0.0; ray < rays; ray += 1.0) {
    const geometry::SinCos angle = geometry::sincos(ray * apart_rad);
    bool begun = false;
    for (double along = 0.5; along <= sight; along += 1.0) {
      const Cell cell{static_cast<std::int32_t>(std::floor(from.x() + along * angle.cos)),
                      static_cast<std::int32_t>(std::floor(from.y() + along * angle.sin))};
      if (!frame_.contains(cell)) break;
      const Kind kind = kinds_[frame_.index(cell)];
      if (kind == Kind::kClosed && !(cell == here)) break;
      begun = begun || kind == Kind::kUnknown;
      if (!begun && along > near) break;
      if (kind == Kind::kUnknown) cells += along * apart_rad;
    }
  }
  return cells * frame_.resolution_m * frame_.resolution_m;
}

}  // namespace topogeo::navigation
