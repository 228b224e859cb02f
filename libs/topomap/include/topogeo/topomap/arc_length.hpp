// Length along a branch.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

/// Distance of each point from the first along the branch, metres. `out` keeps its capacity.
inline void arc_lengths_m(std::span<const BranchPoint> points, std::vector<double>& out) {
  out.assign(points.size(), 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    out[i] = out[i - 1] + (points[i].position_m - points[i - 1].position_m).norm();
  }
}
inline std::vector<double> arc_lengths_m(std::span<const BranchPoint> points) {
  std::vector<double> lengths_m;
  arc_lengths_m(points, lengths_m);
  return lengths_m;
}

}  // namespace topogeo::topomap
