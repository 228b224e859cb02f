// A scan of a post in front of a wall, for tests of obstacle memories.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// A post 0.1 rad wide straight ahead of the robot at `x_m`; everything else is 6 m away.
inline ScanPoints scan_of_post(double x_m, std::int64_t stamp_ns) {
  ScanPoints scan;
  scan.stamp_ns = stamp_ns;
  for (int i = -60; i <= 60; ++i) {
    const double bearing_rad = 0.01 * i;
    const double range_m = std::abs(i) <= 5 ? x_m : 6.0;
    scan.points_m.emplace_back(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
  }
  return scan;
}

}  // namespace topogeo::navigation
