#include "topogeo/planning/occupancy_grid.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::planning {
namespace {

constexpr std::int32_t kMostCellsAlong = 20000;
constexpr std::size_t kMostCells = 100'000'000;
constexpr double kMinResolution_m = 0.01;
constexpr double kMaxResolution_m = 1.0;
constexpr double kMaxCoordinate_m = 1e6;

template <typename Number>
void check_range(const char* field, Number value, Number low, Number high, const char* unit) {
  if (value >= low && value <= high) return;
  std::ostringstream text;
  text << "grid: " << field << " is " << value << ", allowed are " << low << " to " << high << unit;
  throw std::invalid_argument(text.str());
}

}  // namespace

Eigen::Vector2d GridFrame::in_cells(const Eigen::Vector2d& point_m) const {
  // Grids that are not turned, nearly all, keep every bit of the coordinates.
  if (T_map_grid.theta_rad == 0.0) return (point_m - T_map_grid.position_m()) / resolution_m;
  return (geometry::inverse(T_map_grid) * point_m) / resolution_m;
}

std::optional<Cell> GridFrame::cell_of(const Eigen::Vector2d& point_m) const {
  const Eigen::Vector2d at = in_cells(point_m);
  // Also false for what is not a number.
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
  check_range("columns", frame.columns, 1, kMostCellsAlong, "");
  check_range("rows", frame.rows, 1, kMostCellsAlong, "");
  check_range("columns x rows", frame.size(), std::size_t{1}, kMostCells, "");
  check_range("resolution_m", frame.resolution_m, kMinResolution_m, kMaxResolution_m, " m");
  check_range("origin x", frame.T_map_grid.x_m, -kMaxCoordinate_m, kMaxCoordinate_m, " m");
  check_range("origin y", frame.T_map_grid.y_m, -kMaxCoordinate_m, kMaxCoordinate_m, " m");
  check_range("origin yaw", frame.T_map_grid.theta_rad, -7.0, 7.0, " rad");
}

OccupancyGrid::OccupancyGrid(const GridFrame& frame, CellState fill) : frame_(frame) {
  check(frame);
  cells_.assign(frame.size(), fill);
}

}  // namespace topogeo::planning
