// Least squares for the mounting of a laser from motions of robot and laser ("hand-eye
// calibration" in the plane): T_odometry * T_robot_laser = T_robot_laser * T_laser.
#pragma once

#include <span>
#include <vector>

#include "topogeo/calibration/mounting_search.hpp"

namespace topogeo::localization {

/// A mounting and how well it fits.
struct MountingFit {
  geometry::Pose2 T_robot_laser;
  std::vector<double> squared_mahalanobis;  ///< of each motion, three degrees of freedom
  double cost = 0.0;                        ///< their sum, each limited to kOutlying
  /// Covariance of (x, y, yaw), m and rad, by the scatter of the motions or, where they are few,
  /// by the noise that is assumed of them.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();

  /// A motion beyond it is an outlier: 99.9 % of the right ones are within.
  static constexpr double kOutlying = 16.3;
};

/// How well a mounting fits; without its covariance.
MountingFit evaluated(std::span<const LaserMotion> motions, const geometry::Pose2& T_robot_laser);

/// The best position of a laser that faces `yaw_rad`. Turns show it; without them it stays at the
/// centre of the robot.
MountingFit fit_position(std::span<const LaserMotion> motions, double yaw_rad);

/// The best mounting near `start`, with its heading.
MountingFit fit_mounting(std::span<const LaserMotion> motions, const geometry::Pose2& start);

}  // namespace topogeo::localization
