// Velocity of a base that drives and turns.
#pragma once

namespace topogeo::geometry {

struct Velocity {
  double linear_m_per_s = 0.0;     ///< along x of the robot
  double angular_rad_per_s = 0.0;  ///< counter-clockwise
  friend bool operator==(const Velocity&, const Velocity&) = default;
};

}  // namespace topogeo::geometry
