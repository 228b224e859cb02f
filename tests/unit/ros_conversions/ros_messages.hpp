// Messages of ROS for tests.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros {

/// Maximum number of beams of scans without thinning.
inline constexpr std::size_t kMost = 2048;

inline LaserScan laser_scan(double first_rad, double step_rad, std::vector<float> ranges_m,
                            std::int64_t stamp_ns = 0, const std::string& frame = "laser") {
  LaserScan scan;
  scan.header_(header_of(frame, stamp_ns));
  scan.angle_min_(static_cast<float>(first_rad));
  scan.angle_increment_(static_cast<float>(step_rad));
  scan.angle_max_(
      static_cast<float>(first_rad + step_rad * (static_cast<double>(ranges_m.size()) - 1.0)));
  scan.range_min_(0.1F);
  scan.range_max_(30.0F);
  scan.ranges_(std::move(ranges_m));
  return scan;
}

inline Eigen::Isometry3d at(double x_m, double y_m, double yaw_rad, double roll_rad = 0.0) {
  return Eigen::Translation3d(x_m, y_m, 0.3) *
         Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
}

}  // namespace topogeo::ros
