// Basins of clearance: around each local maximum, the cells that are connected to it without a
// narrower place between (a watershed on the distance to the nearest wall; Meyer 1994). Basins meet
// at doors and narrowings of rooms.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/planning/free_space.hpp"

namespace topogeo::planning {

inline constexpr std::uint32_t kNoBasin = 0xffffffff;

/// The pass between two basins.
struct Saddle {
  std::uint32_t a = 0;  ///< < b
  std::uint32_t b = 0;
  double clearance_m = 0.0;  ///< of the widest pair of neighbouring cells
  std::size_t cell = 0;      ///< the cell of that pair in a
};

struct Basins {
  std::vector<std::uint32_t> of_cell;  ///< kNoBasin for walls
  std::vector<double> peak_m;          ///< the largest clearance in each
  std::vector<Saddle> saddles;         ///< sorted by a, then b
};

/// `walls` must count unknown cells as obstacles.
Basins clearance_basins(const FreeSpace& walls);

}  // namespace topogeo::planning
