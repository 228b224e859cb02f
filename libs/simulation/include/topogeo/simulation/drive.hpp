// A smooth drive along waypoints without obstacles.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/tour_follower.hpp"

namespace topogeo::simulation {

struct TimedPose {
  std::int64_t time_ns;  ///< since the start of the drive
  geometry::Pose2 T_world_robot;
};

/// True poses every 20 ms from the first waypoint, heading for the second, until the last is
/// reached. Throws std::invalid_argument if an option is out of range or there are fewer than two
/// different waypoints in succession, std::runtime_error if the end is not reached in twenty times
/// the time of the path at full speed.
std::vector<TimedPose> drive(const std::vector<Eigen::Vector2d>& tour_m,
                             const DriveOptions& options);

}  // namespace topogeo::simulation
