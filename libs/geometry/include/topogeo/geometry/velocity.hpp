// Velocity of a base that drives and turns.
#pragma once

#include <algorithm>
#include <cmath>

namespace topogeo::geometry {

struct Velocity {
  double linear_m_per_s = 0.0;     ///< along x of the robot
  double angular_rad_per_s = 0.0;  ///< counter-clockwise
  friend bool operator==(const Velocity&, const Velocity&) = default;
};

/// The motion nearest to `wanted` that a base with this minimum turning radius (metres, >= 0) can
/// drive: as fast ahead or back, with no tighter turn. A radius of 0 allows every motion.
inline Velocity drivable(const Velocity& wanted, double minimum_radius_m) {
  if (minimum_radius_m <= 0.0) return wanted;
  const double most = std::fabs(wanted.linear_m_per_s) / minimum_radius_m;
  return {wanted.linear_m_per_s, std::clamp(wanted.angular_rad_per_s, -most, most)};
}

}  // namespace topogeo::geometry
