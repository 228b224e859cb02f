// A smooth drive along way points: the robot follows a point that runs ahead of it on the path
// (pure pursuit), slows down to turn, and turns on the spot where the path folds back.
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::simulation {

struct DriveOptions {
  double speed_m_per_s = 0.9;                               ///< at most; (0, 10]
  double turn_rad_per_s = 60.0 * std::numbers::pi / 180.0;  ///< at most; (0, 10]
  double acceleration_m_per_s2 = 0.5;                       ///< (0, 10]
  double lookahead_m = 0.4;  ///< distance of the point ahead; corners are cut by less; [0.05, 5]
};

struct TimedPose {
  std::int64_t time_ns;  ///< since the start of the drive
  geometry::Pose2 T_world_robot;
};

/// True poses every 20 ms from the first way point, heading for the second, until the last is
/// reached. Throws std::invalid_argument when an option is out of range or there are fewer than two
/// different way points in succession, std::runtime_error when the end is not reached in twenty
/// times the time of the path at full speed.
std::vector<TimedPose> drive(const std::vector<Eigen::Vector2d>& tour_m,
                             const DriveOptions& options);

}  // namespace topogeo::simulation
