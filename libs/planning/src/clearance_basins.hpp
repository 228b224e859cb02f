// The floor as basins of clearance: around each place that is wider than all around it, the cells
// from which it is reached without a narrower place between (a watershed on the distance to the
// nearest wall; Meyer 1994). Basins meet where rooms have doors and narrowings.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/planning/free_space.hpp"

namespace topogeo::planning {

inline constexpr std::uint32_t kNoBasin = 0xffffffff;

/// Where two basins meet.
struct Saddle {
  std::uint32_t a = 0;  ///< less than b
  std::uint32_t b = 0;
  double clearance_m = 0.0;  ///< of the widest pair of cells side by side
  std::size_t cell = 0;      ///< of that pair, the one in a
};

struct Basins {
  std::vector<std::uint32_t> of_cell;  ///< kNoBasin for walls
  std::vector<double> peak_m;          ///< the largest clearance in it
  std::vector<Saddle> saddles;         ///< by a, then b
};

/// `walls` must count unknown cells as obstacles.
Basins clearance_basins(const FreeSpace& walls);

}  // namespace topogeo::planning
