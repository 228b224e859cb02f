// Where the laser sits on the robot, from a log: matched scans show how the laser moved, odometry
// shows how the robot moved, and T_robot_laser is the pose between the two: for every motion
// T_odometry * T_robot_laser = T_robot_laser * T_laser ("hand-eye calibration" in the plane).
//
// Turns show where the laser is: it swings about the point that odometry refers to. Straight
// paths show where it looks. Odometry that measures too much or drifts to one side would pass for a
// mounting, so its systematic errors are estimated together with it, and the noise of both with
// them (odometry_calibration.hpp, whose linear model of small errors is repeated here until none is
// left). Where a log does not separate one from another, or has no turns or no driving, the spread
// becomes large and the part is not known.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/calibration/odometry_calibration.hpp"

namespace topogeo::localization {

/// A mounting that is known worse than this is not known: maps would not be better for it. Fixed,
/// as it follows from the matching of maps and not from a robot.
inline constexpr double kLargestMountingSpread_m = 0.05;
inline constexpr double kLargestMountingSpread_rad = 0.035;

/// One part of the mounting.
struct MountingEstimate {
  bool known = false;   ///< false: the log does not show it; the value is that of before
  double value = 0.0;   ///< m or rad
  double spread = 1.0;  ///< one standard deviation; meaningful without `known` too
};

struct LaserCalibration {
  MountingEstimate x_m;       ///< forward of the point that odometry refers to
  MountingEstimate y_m;       ///< to the left of it
  MountingEstimate yaw_rad;   ///< counter-clockwise
  std::size_t with_path = 0;  ///< stretches that bear on yaw
  std::size_t with_turn = 0;  ///< stretches that bear on x and y
  std::size_t motions = 0;    ///< used
  std::size_t outlying = 0;   ///< left out

  /// The parts that are known, the others as they were.
  [[nodiscard]] geometry::Pose2 T_robot_laser() const {
    return {x_m.value, y_m.value, yaw_rad.value};
  }
};

/// `motions` are of the robot, as scans give them with a laser at `T_robot_laser`. `progress`, if
/// any, is called with how many of the refits are done. Throws as calibrate_odometry.
LaserCalibration calibrate_laser(
    std::span<const OdometryStretch> stretches, std::span<const MeasuredMotion> motions,
    const geometry::Pose2& T_robot_laser, const OdometryCalibrationConfig& config,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace topogeo::localization
