// Odometry of ROS as ours.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros_bridge {

/// The pose and the speeds that the message states. Empty for a pose as ros::planar, and for speeds
/// that are no numbers up to 100 m/s and 100 rad/s.
std::optional<geometry::OdometrySample> to_sample(const ros::Odometry& message);

/// The pose that odom -> robot states, with the speeds since `last`: 0 without it and where they
/// would be larger than those of a message, which is a jump. Empty as ros::planar.
std::optional<geometry::OdometrySample> to_sample(
    const ros::TransformStamped& message, const std::optional<geometry::OdometrySample>& last);

/// `epoch`: the odometry that the pose belongs to.
msg::Odometry to_msg(const geometry::OdometrySample& sample, std::string_view robot_id,
                     std::uint64_t epoch, std::uint64_t sequence_number);

}  // namespace topogeo::ros_bridge
