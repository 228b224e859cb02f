// Stamps, poses and rotations between ROS (REP 103: x forward, y left, z up; quaternions x, y, z,
// w) and the plane that we work in.
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

/// Nanoseconds since the epoch. Seconds count without a sign, as ROS 1 has them; no robot of ROS 2
/// has negative ones.
std::int64_t stamp_ns_of(const Time& time);
/// Throws std::invalid_argument for a negative stamp, or one that 32 bits of seconds cannot hold.
Time time_of(std::int64_t stamp_ns);
/// The nearest stamp from which time_of takes all of the next ten seconds: a peer may state any.
std::int64_t usable_stamp_ns(std::int64_t stamp_ns);

/// "base_link" of "/base_link": ROS 1 and tools that grew from it put a slash in front.
std::string frame_name(const std::string& frame_id);

Header header_of(const std::string& frame, std::int64_t stamp_ns);

/// A rotation about z.
Quaternion rotation_of(double yaw_rad);
Point point_of(const Eigen::Vector2d& point_m);
Pose pose_of(const geometry::Pose2& pose);
/// T_parent_child at that time.
TransformStamped transform_of(const std::string& parent, const std::string& child,
                              const geometry::Pose2& T_parent_child, std::int64_t stamp_ns);
/// `covariance` over x, y, heading, frame of the pose; height, roll and pitch are known to be about
/// 0.
PoseWithCovarianceStamped pose_of(const std::string& frame, std::int64_t stamp_ns,
                                  const geometry::Pose2& pose, const Eigen::Matrix3d& covariance);
/// The part over x, y, heading of a covariance over x, y, z and the rotations about them; made
/// symmetric, which rounding may have ended.
Eigen::Matrix3d planar_covariance(const std::array<double, 36>& covariance);

/// Coordinates of a survey have up to 1e7 m. What is far above that is the work of a fault or of a
/// hostile peer, and sums and products of it are soon no numbers.
inline constexpr double kFarthest_m = 1e8;

/// Seen from above: x, y and the heading of the x axis. Empty for a quaternion of no length and for
/// coordinates that are no numbers up to kFarthest_m.
std::optional<geometry::Pose2> planar(const Pose& pose);
std::optional<geometry::Pose2> planar(const Transform& transform);

/// The whole transform; empty as `planar`.
std::optional<Eigen::Isometry3d> isometry_of(const Transform& transform);

}  // namespace topogeo::ros
