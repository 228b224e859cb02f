// What differs between two versions of a map: cell by cell of their grids.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::web {

enum class CellChange : std::uint8_t {
  kSame = 0,
  kGone = 1,  ///< occupied before, free now
  kNew = 2,   ///< free before, occupied now
  kSeen = 3,  ///< unknown before
  kLost = 4,  ///< unknown now
};
inline constexpr std::size_t kCellChanges = 5;

struct MapDifference {
  planning::GridFrame frame;      ///< around both grids
  std::vector<CellChange> cells;  ///< row by row from row 0
  std::array<double, kCellChanges> areas_m2{};
};

/// Walls that moved by a cell are the same: a cell counts as gone or new only where the other grid
/// has nothing occupied in the cells around it. Throws std::invalid_argument where the frame around
/// both would have more than 16 million cells.
MapDifference difference(const planning::OccupancyGrid& before,
                         const planning::OccupancyGrid& after);

/// Upper row first; cells that are the same are transparent.
std::string difference_png(const MapDifference& difference);

}  // namespace topogeo::web
