// Floors to plan on: drawn in text, or blocks of rooms drawn from a seed.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::planning {

/// '#' occupied, '?' unknown, anything else free; the first line is the top row.
inline OccupancyGrid grid_of_text(const std::vector<std::string>& lines,
                                  double resolution_m = 1.0) {
  GridFrame frame;
  frame.columns = static_cast<std::int32_t>(lines[0].size());
  frame.rows = static_cast<std::int32_t>(lines.size());
  frame.resolution_m = resolution_m;
  OccupancyGrid grid(frame, CellState::kFree);
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    const std::string& line = lines[static_cast<std::size_t>(frame.rows - 1 - row)];
    for (std::int32_t column = 0; column < frame.columns; ++column) {
      const char c = line[static_cast<std::size_t>(column)];
      if (c == '#') grid.set({column, row}, CellState::kOccupied);
      if (c == '?') grid.set({column, row}, CellState::kUnknown);
    }
  }
  return grid;
}

struct BlockFloor {
  OccupancyGrid grid;
  std::vector<DrawnZone> rooms;
};

/// Size of a block floor; lengths in cells of 0.1 m.
struct BlockPlan {
  std::int32_t columns = 4;  ///< of rooms
  std::int32_t rows = 3;
  std::int32_t room_width = 50;  ///< with its walls, which are one cell thick
  std::int32_t room_height = 40;
  std::int32_t door = 10;      ///< width
  std::int32_t furniture = 2;  ///< pieces in a room
};

inline void fill_box(OccupancyGrid& grid, Cell low, Cell high, CellState state) {
  for (std::int32_t row = low.row; row <= high.row; ++row) {
    for (std::int32_t column = low.column; column <= high.column; ++column) {
      grid.set({column, row}, state);
    }
  }
}

/// Rooms side by side. Each has a door to its left neighbour; those of the first column have one to
/// the room above, the others with even chance. So every room can be reached.
inline BlockFloor block_floor(const BlockPlan& plan, std::uint64_t seed) {
  support::Random random(seed);
  const auto between = [&random](std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(
                     random.below(static_cast<std::uint64_t>(std::max(high - low, 0)) + 1));
  };
  GridFrame frame;
  frame.columns = plan.columns * plan.room_width;
  frame.rows = plan.rows * plan.room_height;
  BlockFloor floor{OccupancyGrid(frame, CellState::kFree), {}};
  constexpr std::int32_t kFree = 8;  // between furniture and walls, so that a robot fits
  for (std::int32_t j = 0; j < plan.rows; ++j) {
    for (std::int32_t i = 0; i < plan.columns; ++i) {
      const Cell low{i * plan.room_width, j * plan.room_height};
      const Cell high{low.column + plan.room_width - 1, low.row + plan.room_height - 1};
      fill_box(floor.grid, low, {low.column, high.row}, CellState::kOccupied);
      fill_box(floor.grid, low, {high.column, low.row}, CellState::kOccupied);
      for (std::int32_t k = 0; k < plan.furniture; ++k) {
        const Cell corner{between(low.column + kFree, high.column - 2 * kFree),
                          between(low.row + kFree, high.row - 2 * kFree)};
        fill_box(floor.grid, corner,
                 {corner.column + between(1, kFree), corner.row + between(1, kFree)},
                 CellState::kOccupied);
      }
      if (i > 0) {
        const std::int32_t at = between(low.row + 1, high.row - plan.door);
        fill_box(floor.grid, {low.column, at}, {low.column, at + plan.door - 1}, CellState::kFree);
      }
      if (j > 0 && (i == 0 || random.below(2) == 0)) {
        const std::int32_t at = between(low.column + 1, high.column - plan.door);
        fill_box(floor.grid, {at, low.row}, {at + plan.door - 1, low.row}, CellState::kFree);
      }
      const double cell_m = frame.resolution_m;
      const Eigen::Vector2d from_m = cell_m * Eigen::Vector2d(low.column, low.row);
      const Eigen::Vector2d to_m = cell_m * Eigen::Vector2d(high.column + 1, high.row + 1);
      floor.rooms.push_back({"room " + std::to_string(floor.rooms.size()),
                             {from_m, {to_m.x(), from_m.y()}, to_m, {from_m.x(), to_m.y()}}});
    }
  }
  fill_box(floor.grid, {frame.columns - 1, 0}, {frame.columns - 1, frame.rows - 1},
           CellState::kOccupied);
  fill_box(floor.grid, {0, frame.rows - 1}, {frame.columns - 1, frame.rows - 1},
           CellState::kOccupied);
  return floor;
}

/// The centre of a random passable cell.
inline Eigen::Vector2d random_free_point_m(const FreeSpace& space, support::Random& random) {
  while (true) {
    const Cell cell = space.frame().cell_at(random.below(space.frame().size()));
    if (space.passable(cell)) return space.frame().center_m(cell);
  }
}

}  // namespace topogeo::planning
