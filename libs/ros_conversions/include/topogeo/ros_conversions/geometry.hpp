// Converts stamps, poses and rotations between ROS (REP 103: x forward, y left, z up; quaternions
// x, y, z, w) and our plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros {

/// Nanoseconds since the epoch. Seconds are read as unsigned, as in ROS 1; robots of ROS 2 have no
/// negative ones.
std::int64_t stamp_ns_of(const Time& time);
/// Throws std::invalid_argument for a negative stamp, or one that 32 bits of seconds cannot hold.
Time time_of(std::int64_t stamp_ns);
/// The nearest stamp for which time_of accepts all of the next ten seconds, because a peer may
/// state any.
std::int64_t usable_stamp_ns(std::int64_t stamp_ns);

/// "base_link" for "/base_link": ROS 1 and tools derived from it put a slash in front.
std::string frame_name(const std::string& frame_id);

Header header_of(const std::string& frame, std::int64_t stamp_ns);

/// A rotation about z.
Quaternion rotation_of(double yaw_rad);
Point point_of(const Eigen::Vector2d& point_m);
Pose pose_of(const geometry::Pose2& pose);
/// T_parent_child at `stamp_ns`.
TransformStamped transform_of(const std::string& parent, const std::string& child,
                              const geometry::Pose2& T_parent_child, std::int64_t stamp_ns);
/// `covariance` over x, y, heading, frame of the pose; height, roll and pitch are about 0.
PoseWithCovarianceStamped pose_of(const std::string& frame, std::int64_t stamp_ns,
                                  const geometry::Pose2& pose, const Eigen::Matrix3d& covariance);
/// The part over x, y, heading of a covariance over x, y, z and the rotations about them, made
/// symmetric again after rounding.
Eigen::Matrix3d planar_covariance(const std::array<double, 36>& covariance);

/// Survey coordinates reach 1e7 m. Much larger ones come from a fault or a hostile peer, and their
/// sums and products soon overflow.
inline constexpr double kFarthest_m = 1e8;

/// Plan view: x, y and the heading of the x axis. Empty for a zero quaternion and for coordinates
/// that are not finite or exceed kFarthest_m.
std::optional<geometry::Pose2> planar(const Pose& pose);
std::optional<geometry::Pose2> planar(const Transform& transform);

/// The whole transform; empty in the same cases as `planar`.
std::optional<Eigen::Isometry3d> isometry_of(const Transform& transform);

}  // namespace topogeo::ros
