// Distance sensors of Markov localization: sonars, or some beams of a laser.
#pragma once

#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::markov {

/// A sensor along x of its own frame that measures the nearest obstacle within its cone.
struct RangeSensor {
  geometry::Pose2 T_robot_sensor{};
  double half_cone_rad = 0.0;  ///< half of the opening angle; 0: a single ray, like a laser beam
};

/// Every `every`-th beam of a laser, starting with the first, as range sensors. Only the beams of
/// `scan` count, not its readings. Throws std::invalid_argument if `every` is below 1.
std::vector<RangeSensor> laser_sensors(const geometry::Pose2& T_robot_laser, const scan::Scan& scan,
                                       int every);

/// The readings of those beams, scan::Scan::kNoReturn without an echo. Throws as above.
std::vector<float> laser_ranges(const scan::Scan& scan, int every);

}  // namespace topogeo::markov
