// Places and directions of the sonars of a robot.
#pragma once

#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {

/// One transducer; it looks along x of its own frame.
struct SonarMount {
  geometry::Pose2 T_robot_sonar{};
  double half_cone_rad = 15.0 * std::numbers::pi / 180.0;  ///< half of the opening angle, > 0
};

/// MACONDO's six: two to the front, two to the left, two to the right. MACONDO gives only their
/// directions; the mounting assumes a round body of 26 cm with the pairs 20 cm apart.
std::vector<SonarMount> macondo_sonars();

inline constexpr double kB21Radius_m = 0.267;

/// The 24 of a B21: one every 15 degrees at the radius of its body, counter-clockwise from the
/// first one left of ahead.
std::vector<SonarMount> b21_sonars();

/// The 16 of a Pioneer 3-DX, by their numbers: eight of the front array from the left to the right,
/// eight of the rear array (maker's parameter files). The arrays of other Pioneers lie at the same
/// angles, and up to 4 cm elsewhere.
std::vector<SonarMount> pioneer_sonars();

}  // namespace topogeo::devices
