// A pose of the robot from any message that states one with a time: odometry of wheels, or a pose
// that another program or a tracking system measured.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::recording {

/// Whether messages of this type (Topic::type) state one pose: Odometry, PoseStamped,
/// PoseWithCovarianceStamped or TransformStamped.
bool states_pose(std::string_view type);

struct OdometryMessage {
  ros::Header header;
  std::string child_frame;                      ///< empty: the message has none
  std::optional<geometry::Pose2> T_odom_robot;  ///< empty if it is not finite
};

/// A message of such a type. Throws DecodeError.
OdometryMessage decode_odometry(std::string_view type, std::span<const std::byte> bytes,
                                Encoding encoding);

}  // namespace topogeo::recording
