// Laser scans of ROS to ours and back (sensor_msgs/LaserScan, REP 103).
#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/recording/ros_types.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::recording {

/// Where a laser sits, seen from above.
struct LaserMounting {
  geometry::Pose2 T_robot_laser;  ///< of an upside-down laser: of the frame that is its own turned
                                  ///< about x by pi
  bool upside_down = false;       ///< its beams then go clockwise
  double tilt_rad = 0.0;          ///< between its plane and the floor, in [0, pi / 2]

  friend bool operator==(const LaserMounting&, const LaserMounting&) = default;
};

/// Rounded to 0.1 mm and 0.00001 rad like that of a CARMEN log, so that one drive has the same
/// mounting in each format.
LaserMounting planar_mounting(const Eigen::Isometry3d& T_robot_laser);

/// The beams of a scan with angles that grow counter-clockwise; stamp, odometry and sequence are
/// left to the caller. A range that is no echo (not a number, infinite, at or below 0, below
/// range_min, at or above range_max, or at or above `range_limit_m`) becomes kNoReturn. Of more
/// than 2,048 beams every second, third ... is taken. Throws std::invalid_argument ("expected ...,
/// got ...") for angles that no laser has.
scan::Scan to_scan(const ros::LaserScan& message, bool upside_down, double range_limit_m);

/// The other way, with stamp; a beam without an echo becomes +inf.
ros::LaserScan from_scan(const scan::Scan& scan, const std::string& frame_id);

/// Seen from above. Empty for a quaternion of no length and for coordinates that are not finite.
std::optional<geometry::Pose2> planar_pose(const ros::Pose& pose);
std::optional<geometry::Pose2> planar_pose(const ros::Transform& transform);
ros::Quaternion to_quaternion(double yaw_rad);
Eigen::Isometry3d to_isometry(const ros::Transform& transform);

/// Nanoseconds since the epoch.
std::int64_t to_stamp_ns(const ros::Time& time);
/// Throws std::invalid_argument for a negative one, or one that 32 bits of seconds cannot hold.
ros::Time from_stamp_ns(std::int64_t stamp_ns);

/// Without the slash that frames of ROS 1 may start with.
std::string frame_name(const std::string& frame_id);

}  // namespace topogeo::recording
