#include "topogeo/planning/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/check_range.hpp"

namespace topogeo::planning {
namespace {

constexpr double kMostCellsAlong = 20'000;  // 1 km of cells of 5 cm
constexpr double kMostCells = 100'000'000;  // a search keeps about ten bytes for each
constexpr double kMinResolution_m = 0.01;   // finer than any laser measures
constexpr double kMaxResolution_m = 1.0;    // coarser cells hide every door
constexpr double kMaxCoordinate_m = 1e6;    // a cell is still exact to a thousandth
constexpr double kMaxYaw_rad = 7.0;         // one turn in either direction, plus rounding

}  // namespace

Eigen::Vector2d GridFrame::in_cells(const Eigen::Vector2d& point_m) const {
  // Unrotated grids, nearly all, keep every bit of the coordinates.
  if (T_map_grid.theta_rad == 0.0) return (point_m - T_map_grid.position_m()) / resolution_m;
  return (geometry::inverse(T_map_grid) * point_m) / resolution_m;
}

std::optional<Cell> GridFrame::cell_of(const Eigen::Vector2d& point_m) const {
  const Eigen::Vector2d at = in_cells(point_m);
  // Also false for NaN.
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < columns && at.y() < rows)) return std::nullopt;
  return Cell{static_cast<std::int32_t>(at.x()), static_cast<std::int32_t>(at.y())};
}

Eigen::Vector2d GridFrame::center_m(const Cell& cell) const {
  const Eigen::Vector2d in_grid_m =
      resolution_m * Eigen::Vector2d(cell.column + 0.5, cell.row + 0.5);
  if (T_map_grid.theta_rad == 0.0) return T_map_grid.position_m() + in_grid_m;
  return T_map_grid * in_grid_m;
}

void check(const GridFrame& frame) {
  using support::check_range;
  const geometry::Pose2& origin = frame.T_map_grid;
  check_range("grid: columns", frame.columns, 1, kMostCellsAlong);
  check_range("grid: rows", frame.rows, 1, kMostCellsAlong);
  check_range("grid: columns x rows", static_cast<double>(frame.size()), 1, kMostCells);
  check_range("grid: resolution_m", frame.resolution_m, kMinResolution_m, kMaxResolution_m, "m");
  check_range("grid: origin x", origin.x_m, -kMaxCoordinate_m, kMaxCoordinate_m, "m");
  check_range("grid: origin y", origin.y_m, -kMaxCoordinate_m, kMaxCoordinate_m, "m");
  check_range("grid: origin yaw", origin.theta_rad, -kMaxYaw_rad, kMaxYaw_rad, "rad");
}

GridFrame frame_around(std::span<const Eigen::Vector2d> points_m, double margin_m) {
  constexpr double kCell_m = 0.1;
  constexpr double kMostAlong = 2000.0;
  Eigen::Vector2d low_m = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high_m = -low_m;
  for (const Eigen::Vector2d& point_m : points_m) {
    low_m = low_m.cwiseMin(point_m);
    high_m = high_m.cwiseMax(point_m);
  }
  const Eigen::Vector2d side_m = high_m - low_m + Eigen::Vector2d::Constant(2.0 * margin_m);
  GridFrame frame;
  frame.resolution_m = std::clamp(side_m.maxCoeff() / kMostAlong, kCell_m, kMaxResolution_m);
  frame.columns = static_cast<std::int32_t>(side_m.x() / frame.resolution_m) + 1;
  frame.rows = static_cast<std::int32_t>(side_m.y() / frame.resolution_m) + 1;
  frame.T_map_grid = {low_m.x() - margin_m, low_m.y() - margin_m, 0.0};
  return frame;
}

OccupancyGrid::OccupancyGrid(const GridFrame& frame, CellState fill) : frame_(frame) {
  check(frame);
  cells_.assign(frame.size(), fill);
}

}  // namespace topogeo::planning
