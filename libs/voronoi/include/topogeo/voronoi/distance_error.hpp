// Error of using a cell's centre for every point of the cell (Thesis, 4.2.2.2, eq. 4.17 and 4.18,
// table 4.1).
#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace topogeo::voronoi {

/// E_max: half the diagonal of a cell, metres. The distance of a cell's centre to a group differs
/// from that of any other point of the cell by at most this, and the distances of a cell to its
/// base groups differ by less than twice this (4.19). Throws std::invalid_argument if the side of
/// the cell, `resolution_m`, is not finite and above zero.
inline double largest_distance_error_m(double resolution_m) {
  if (!std::isfinite(resolution_m) || resolution_m <= 0.0) {
    throw std::invalid_argument("resolution_m " + std::to_string(resolution_m) +
                                ": must be finite and > 0");
  }
  return 0.5 * std::numbers::sqrt2 * resolution_m;
}

}  // namespace topogeo::voronoi
