// Invariants of the bridge for a readable ROS message.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::fuzz {

inline constexpr std::int64_t kRosNow_ns = 1'700'000'000'000'000'000;
/// Mounting of the laser in these checks.
inline constexpr geometry::Pose2 kRosMounting{0.1, 0.0, 0.0};

/// Clamps a stamp outside the range of ROS to its first or last one.
ros::Header header_at(const std::string& frame, std::int64_t stamp_ns);

/// Half a turn, all ranges two metres.
ros::LaserScan scan_at(std::int64_t stamp_ns, const std::string& frame = "laser");

// Each returns whether the bridge produces output for the message. Throws std::invalid_argument,
// which the bridge counts, and BrokenPromise.

bool receive_in_bridge(const ros::LaserScan& message);
bool receive_in_bridge(const ros::Odometry& message);
/// Tests it as a message of /tf_static, and of /tf with each transform from odom to robot.
bool receive_in_bridge(const ros::TFMessage& message);
bool receive_in_bridge(const ros::PoseStamped& message);
bool receive_in_bridge(const ros::PoseWithCovarianceStamped& message);
bool receive_in_bridge(const ros::Twist& message);
bool receive_in_bridge(const ros::TwistStamped& message);

}  // namespace topogeo::fuzz
