#include "history/map_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "channels/palette_png.hpp"

namespace topogeo::web {
namespace {

using planning::Cell;
using planning::CellState;
using planning::GridFrame;
using planning::OccupancyGrid;

constexpr double kMostCells = 16e6;

/// A frame parallel to the map that encloses both grids, with the cells of `a`, aligned to
/// multiples of their size.
GridFrame frame_of_both(const GridFrame& a, const GridFrame& b) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const GridFrame* frame : {&a, &b}) {
    for (const Cell& corner : {Cell{0, 0}, Cell{frame->columns - 1, 0}, Cell{0, frame->rows - 1},
                               Cell{frame->columns - 1, frame->rows - 1}}) {
      const Eigen::Vector2d middle = frame->center_m(corner);
      // Covers a cell in any rotation, with a margin.
      const Eigen::Vector2d half = Eigen::Vector2d::Constant(frame->resolution_m);
      low = low.cwiseMin(middle - half);
      high = high.cwiseMax(middle + half);
    }
  }
  GridFrame frame;
  frame.resolution_m = a.resolution_m;
  const auto snapped = [&](double value) {
    return std::floor(value / frame.resolution_m) * frame.resolution_m;
  };
  frame.T_map_grid = {snapped(low.x()), snapped(low.y()), 0.0};
  const double columns = std::ceil((high.x() - frame.T_map_grid.x_m) / frame.resolution_m);
  const double rows = std::ceil((high.y() - frame.T_map_grid.y_m) / frame.resolution_m);
  if (columns * rows > kMostCells) throw std::invalid_argument("the maps are too large to compare");
  frame.columns = static_cast<std::int32_t>(columns);
  frame.rows = static_cast<std::int32_t>(rows);
  return frame;
}

CellState state_of(const OccupancyGrid& grid, const std::optional<Cell>& cell) {
  return cell ? grid.at(*cell) : CellState::kUnknown;
}

bool occupied_around(const OccupancyGrid& grid, const std::optional<Cell>& cell) {
  if (!cell) return false;
  for (std::int32_t row = cell->row - 1; row <= cell->row + 1; ++row) {
    for (std::int32_t column = cell->column - 1; column <= cell->column + 1; ++column) {
      const Cell other{column, row};
      if (grid.frame().contains(other) && grid.at(other) == CellState::kOccupied) return true;
    }
  }
  return false;
}

CellChange change_at(const OccupancyGrid& before, const OccupancyGrid& after,
                     const Eigen::Vector2d& point_m) {
  const std::optional<Cell> cell_before = before.frame().cell_of(point_m);
  const std::optional<Cell> cell_after = after.frame().cell_of(point_m);
  const CellState was = state_of(before, cell_before);
  const CellState is = state_of(after, cell_after);
  if (was == is) return CellChange::kSame;
  if (was == CellState::kUnknown) return CellChange::kSeen;
  if (is == CellState::kUnknown) return CellChange::kLost;
  if (was == CellState::kOccupied) {
    return occupied_around(after, cell_after) ? CellChange::kSame : CellChange::kGone;
  }
  return occupied_around(before, cell_before) ? CellChange::kSame : CellChange::kNew;
}

}  // namespace

MapDifference difference(const OccupancyGrid& before, const OccupancyGrid& after) {
  MapDifference out;
  out.frame = frame_of_both(before.frame(), after.frame());
  out.cells.resize(out.frame.size());
  std::array<std::size_t, kCellChanges> counts{};
  for (std::size_t i = 0; i < out.cells.size(); ++i) {
    out.cells[i] = change_at(before, after, out.frame.center_m(out.frame.cell_at(i)));
    ++counts.at(static_cast<std::size_t>(out.cells[i]));
  }
  const double cell_m2 = out.frame.resolution_m * out.frame.resolution_m;
  std::ranges::transform(counts, out.areas_m2.begin(), [cell_m2](std::size_t count) {
    return cell_m2 * static_cast<double>(count);
  });
  return out;
}

std::string difference_png(const MapDifference& difference) {
  constexpr std::array<Color, kCellChanges> kChangeColors = {{{0, 0, 0, 0},
                                                              {214, 39, 40, 255},
                                                              {31, 119, 180, 255},
                                                              {44, 160, 44, 110},
                                                              {127, 127, 127, 130}}};
  const auto columns = static_cast<std::size_t>(difference.frame.columns);
  const auto rows = static_cast<std::size_t>(difference.frame.rows);
  std::vector<std::uint8_t> pixels;
  pixels.reserve(columns * rows);
  for (std::size_t row = rows; row-- > 0;) {
    for (std::size_t column = 0; column < columns; ++column) {
      pixels.push_back(static_cast<std::uint8_t>(difference.cells[row * columns + column]));
    }
  }
  return palette_png(static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), pixels,
                     kChangeColors);
}

}  // namespace topogeo::web
