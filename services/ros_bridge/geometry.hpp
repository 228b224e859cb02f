// Stamps, poses and rotations between ROS (REP 103: x forward, y left, z up; quaternions x, y, z,
// w) and the plane that we work in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_messaging/messages.hpp"

namespace topogeo::ros_bridge {

/// Nanoseconds since the epoch; what is out of range (nanosec of 1e9 or more) counts as it is.
std::int64_t from_ros(const ros::Time& time);
ros::Time to_ros(std::int64_t stamp_ns);

/// "base_link" of "/base_link": ROS 1 and tools that grew from it put a slash in front.
std::string frame_name(const std::string& frame_id);

ros::Header header_of(const std::string& frame, std::int64_t stamp_ns);

/// A rotation about z.
ros::Quaternion rotation_of(double yaw_rad);
ros::Pose to_ros(const geometry::Pose2& pose);

/// The unit quaternion; empty for one of no length or that is no number.
std::optional<Eigen::Quaterniond> rotation_from(const ros::Quaternion& rotation);

/// A pose seen from above: x, y and the heading of its x axis. Empty where it is no pose (see
/// rotation_from, coordinates that are not finite).
std::optional<geometry::Pose2> planar(const ros::Pose& pose);

/// The whole transform; empty as `planar`.
std::optional<Eigen::Isometry3d> isometry_from(const ros::TransformStamped& transform);

/// T_parent_child of the message seen from above, z, roll and pitch left out.
geometry::Pose2 planar(const Eigen::Isometry3d& transform);

ros::TransformStamped to_transform(const std::string& parent, const std::string& child,
                                   const geometry::Pose2& T_parent_child, std::int64_t stamp_ns);

}  // namespace topogeo::ros_bridge
