// Conversion of ROS odometry to ours.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros_bridge {

/// Pose and speeds of the message. Empty if ros::planar rejects the pose, or a speed is not finite
/// or exceeds 100 m/s or 100 rad/s.
std::optional<geometry::OdometrySample> to_sample(const ros::Odometry& message);

/// Pose of the transform odom -> robot, with the speeds since `last`. The speeds are 0 without
/// `last` and where they would exceed the limits of a message, which means a jump. Empty like
/// ros::planar.
std::optional<geometry::OdometrySample> to_sample(
    const ros::TransformStamped& message, const std::optional<geometry::OdometrySample>& last);

/// `epoch`: epoch of the odometry that the pose belongs to.
msg::Odometry to_msg(const geometry::OdometrySample& sample, std::string_view robot_id,
                     std::uint64_t epoch, std::uint64_t sequence_number);

}  // namespace topogeo::ros_bridge
