#include "grid_view.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace topogeo::navigation {

using planning::Cell;
using planning::CellState;
using planning::GridFrame;
using planning::OccupancyGrid;

namespace {

/// The cell around any point, also beyond the grid.
Cell around(const GridFrame& frame, const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d in_cells = frame.in_cells(point_m);
  return {static_cast<std::int32_t>(std::floor(in_cells.x())),
          static_cast<std::int32_t>(std::floor(in_cells.y()))};
}

/// Calls `visit` for every cell of the grid whose middle is at most `reach_m` from the point.
template <class Visit>
void visit_disc(const GridFrame& frame, const Eigen::Vector2d& point_m, double reach_m,
                Visit visit) {
  const Cell middle = around(frame, point_m);
  const auto reach = static_cast<std::int32_t>(std::ceil(reach_m / frame.resolution_m));
  for (std::int32_t row = middle.row - reach; row <= middle.row + reach; ++row) {
    for (std::int32_t column = middle.column - reach; column <= middle.column + reach; ++column) {
      const Cell cell{column, row};
      if (!frame.contains(cell)) continue;
      if ((frame.center_m(cell) - point_m).norm() <= reach_m) visit(cell);
    }
  }
}

}  // namespace

std::optional<Cell> best_cell(const GridFrame& frame, const Eigen::Vector2d& point_m,
                              double reach_m, const std::function<bool(const Cell&)>& good,
                              const std::function<double(const Eigen::Vector2d&)>& cost) {
  std::optional<Cell> best;
  double best_cost = std::numeric_limits<double>::infinity();
  visit_disc(frame, point_m, reach_m, [&](const Cell& cell) {
    const double cell_cost = cost(frame.center_m(cell));
    if (cell_cost >= best_cost || !good(cell)) return;
    best = cell;
    best_cost = cell_cost;
  });
  return best;
}

std::optional<Cell> nearest_cell(const GridFrame& frame, const Eigen::Vector2d& point_m,
                                 double reach_m, const std::function<bool(const Cell&)>& good) {
  return best_cell(frame, point_m, reach_m, good,
                   [&](const Eigen::Vector2d& at_m) { return (at_m - point_m).norm(); });
}

std::optional<Cell> nearest_passable(const planning::FreeSpace& space,
                                     const Eigen::Vector2d& point_m, double reach_m) {
  return nearest_cell(space.frame(), point_m, reach_m,
                      [&](const Cell& cell) { return space.passable(cell); });
}

bool nothing_between(const OccupancyGrid& grid, const Eigen::Vector2d& a_m,
                     const Eigen::Vector2d& b_m) {
  constexpr double kStepsPerCell = 3.0;
  const double length_m = (b_m - a_m).norm();
  const double steps = std::ceil(kStepsPerCell * length_m / grid.frame().resolution_m);
  for (double step = 0.0; step <= steps; step += 1.0) {
    const Eigen::Vector2d at_m = steps > 0.0 ? a_m + (step / steps) * (b_m - a_m) : a_m;
    const auto cell = grid.frame().cell_of(at_m);
    if (cell && grid.at(*cell) == CellState::kOccupied) return false;
  }
  return true;
}

bool beside_unknown(const OccupancyGrid& grid, const Cell& cell) {
  constexpr std::array<Cell, 4> kBeside = {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}};
  for (const Cell& step : kBeside) {
    const Cell other{cell.column + step.column, cell.row + step.row};
    if (!grid.frame().contains(other) || grid.at(other) == CellState::kUnknown) return true;
  }
  return false;
}

bool any_unknown(const OccupancyGrid& grid, const Eigen::Vector2d& point_m, double reach_m) {
  bool found = false;
  visit_disc(grid.frame(), point_m, reach_m,
             [&](const Cell& cell) { found = found || grid.at(cell) == CellState::kUnknown; });
  return found;
}

bool unknown_near(const OccupancyGrid& grid, const Eigen::Vector2d& point_m, double reach_m) {
  return nearest_cell(grid.frame(), point_m, reach_m,
                      [&](const Cell& cell) {
                        return grid.at(cell) == CellState::kFree && beside_unknown(grid, cell);
                      })
      .has_value();
}

Eigen::Vector2d toward_unknown(const OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                               double reach_m) {
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  visit_disc(grid.frame(), point_m, reach_m, [&](const Cell& cell) {
    if (grid.at(cell) == CellState::kUnknown) sum_m += grid.frame().center_m(cell) - point_m;
  });
  if (sum_m.norm() < 1e-6) return Eigen::Vector2d::UnitX();
  return sum_m;
}

}  // namespace topogeo::navigation
