// The difference between two versions of a map, cell by cell of their grids.
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
  kSeen = 3,  ///< was unknown
  kLost = 4,  ///< is unknown now
};
inline constexpr std::size_t kCellChanges = 5;

struct MapDifference {
  planning::GridFrame frame;      ///< encloses both grids
  std::vector<CellChange> cells;  ///< row by row from row 0
  std::array<double, kCellChanges> areas_m2{};
};

/// A wall that moved by one cell counts as unchanged: a cell is gone or new only if the other grid
/// has nothing occupied in the cells around it. Throws std::invalid_argument when the frame around
/// both would have more than 16 million cells.
MapDifference difference(const planning::OccupancyGrid& before,
                         const planning::OccupancyGrid& after);

/// Top row first; unchanged cells are transparent.
std::string difference_png(const MapDifference& difference);

}  // namespace topogeo::web
