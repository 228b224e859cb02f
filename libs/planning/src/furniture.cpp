#include "furniture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "topogeo/planning/free_space.hpp"

namespace topogeo::planning {
namespace {

/// Obstacle cells connected over sides and corners.
struct Block {
  std::vector<std::size_t> cells;
  bool at_edge = false;  ///< touches the edge of the grid
};

Block take_block(const OccupancyGrid& walls, std::size_t first, std::vector<bool>& taken) {
  const GridFrame& frame = walls.frame();
  Block block{{first}};
  taken[first] = true;
  for (std::size_t done = 0; done < block.cells.size(); ++done) {
    const Cell at = frame.cell_at(block.cells[done]);
    for (std::int32_t row = at.row - 1; row <= at.row + 1; ++row) {
      for (std::int32_t column = at.column - 1; column <= at.column + 1; ++column) {
        if (!frame.contains({column, row})) {
          block.at_edge = true;
          continue;
        }
        const std::size_t i = frame.index({column, row});
        if (taken[i] || walls.cells()[i] != CellState::kOccupied) continue;
        taken[i] = true;
        block.cells.push_back(i);
      }
    }
  }
  return block;
}

/// Distances of occupied cells to the nearest free one.
FreeSpace depths(const OccupancyGrid& walls) {
  OccupancyGrid turned(walls.frame());
  for (std::size_t i = 0; i < walls.cells().size(); ++i) {
    const bool free = walls.cells()[i] == CellState::kFree;
    turned.set(walls.frame().cell_at(i), free ? CellState::kOccupied : CellState::kFree);
  }
  return FreeSpace(std::move(turned), {.forbidden_cells = 0.0, .min_pocket_m2 = 0.0});
}

/// The cell farthest from another one, and the distance in cells.
std::pair<Cell, double> farthest_from(const GridFrame& frame, const Block& block,
                                      const Cell& from) {
  std::pair<Cell, double> farthest{from, 0.0};
  for (const std::size_t i : block.cells) {
    const Cell cell = frame.cell_at(i);
    const double away = std::hypot(cell.column - from.column, cell.row - from.row);
    if (away > farthest.second) farthest = {cell, away};
  }
  return farthest;
}

/// The length of an elongated block, at any orientation.
double length_cells(const GridFrame& frame, const Block& block) {
  const Cell end = farthest_from(frame, block, frame.cell_at(block.cells.front())).first;
  return farthest_from(frame, block, end).second + 1.0;
}

/// Twice the area of the triangle; > 0 for a left turn.
double turn(const Cell& a, const Cell& b, const Cell& c) {
  return static_cast<double>(b.column - a.column) * (c.row - a.row) -
         static_cast<double>(b.row - a.row) * (c.column - a.column);
}

/// The filled fraction of a block's convex hull (Andrew's monotone chain); walls that meet at
/// corners fill little of theirs.
double solidity(const GridFrame& frame, const Block& block) {
  std::vector<Cell> corners;
  for (const std::size_t i : block.cells) {
    const Cell cell = frame.cell_at(i);
    for (const Cell& step : {Cell{0, 0}, Cell{1, 0}, Cell{0, 1}, Cell{1, 1}}) {
      corners.push_back({cell.column + step.column, cell.row + step.row});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const Cell& a, const Cell& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  double twice_area = 0.0;
  for (int side = 0; side < 2; ++side) {
    std::vector<Cell> hull;
    for (const Cell& corner : corners) {
      while (hull.size() > 1 && turn(hull[hull.size() - 2], hull.back(), corner) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(corner);
    }
    for (std::size_t i = 1; i + 1 < hull.size(); ++i) {
      twice_area += turn(hull.front(), hull[i], hull[i + 1]);
    }
    std::reverse(corners.begin(), corners.end());
  }
  return 2.0 * static_cast<double>(block.cells.size()) / twice_area;
}

bool is_furniture(const Block& block, const FreeSpace& depth, const RoomConfig& config) {
  if (block.at_edge) return false;
  const double cell_m = depth.frame().resolution_m;
  const double length_m = cell_m * length_cells(depth.frame(), block);
  if (length_m <= config.column_m) return true;
  std::int32_t deepest = 0;
  std::size_t inner = 0;
  const double from_cells = 0.5 * config.furniture_from_m / cell_m;
  for (const std::size_t i : block.cells) {
    deepest = std::max(deepest, depth.squared_cells(i));
    if (depth.squared_cells(i) > from_cells * from_cells) ++inner;
  }
  const double thick_m = 2.0 * cell_m * std::sqrt(static_cast<double>(deepest));
  constexpr double kCompact = 0.6;  // a rack with a pallet beside it; walls fill less
  return 2 * inner >= block.cells.size() && thick_m <= config.furniture_to_m &&
         solidity(depth.frame(), block) >= kCompact;
}

}  // namespace

OccupancyGrid without_furniture(const OccupancyGrid& grid, const RoomConfig& config) {
  OccupancyGrid walls(grid.frame());
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    const bool free = grid.cells()[i] == CellState::kFree;
    walls.set(grid.frame().cell_at(i), free ? CellState::kFree : CellState::kOccupied);
  }
  const FreeSpace depth = depths(walls);
  std::vector<bool> taken(grid.frame().size(), false);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i] || walls.cells()[i] != CellState::kOccupied) continue;
    const Block block = take_block(walls, i, taken);
    if (!is_furniture(block, depth, config)) continue;
    for (const std::size_t cell : block.cells)
      walls.set(grid.frame().cell_at(cell), CellState::kFree);
  }
  return walls;
}

}  // namespace topogeo::planning
