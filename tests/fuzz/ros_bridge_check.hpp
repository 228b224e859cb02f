// What must hold of what the bridge does with a message of ROS that could be read.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::fuzz {

inline constexpr std::int64_t kRosNow_ns = 1'700'000'000'000'000'000;
/// Where the robot of the checks has its laser.
inline constexpr geometry::Pose2 kRosMounting{0.1, 0.0, 0.0};

/// A stamp before or after all that ROS knows becomes the first or the last.
ros::Header header_at(const std::string& frame, std::int64_t stamp_ns);

/// Half a turn, two metres from everything.
ros::LaserScan scan_at(std::int64_t stamp_ns, const std::string& frame = "laser");

// Each returns whether the bridge makes something of the message. Throws std::invalid_argument,
// which the bridge counts, and BrokenPromise.

bool receive_in_bridge(const ros::LaserScan& message);
bool receive_in_bridge(const ros::Odometry& message);
/// As of /tf_static, and as of /tf with each transform one of odom -> robot.
bool receive_in_bridge(const ros::TFMessage& message);
bool receive_in_bridge(const ros::PoseStamped& message);
bool receive_in_bridge(const ros::PoseWithCovarianceStamped& message);
bool receive_in_bridge(const ros::Twist& message);
bool receive_in_bridge(const ros::TwistStamped& message);

}  // namespace topogeo::fuzz
