// Pose of the laser on the robot, estimated from a log. Matched scans show how the laser moved,
// odometry shows how the robot moved, and T_robot_laser is the pose between the two: every motion
// satisfies T_odometry * T_robot_laser = T_robot_laser * T_laser ("hand-eye calibration" in the
// plane).
//
// Turns show the position of the laser, because it swings about the reference point of the
// odometry. Straight paths show its yaw. Systematic errors of the odometry (a wrong scale, a drift
// to one side) look like a different mounting, so both are estimated together with their noise
// (odometry_calibration.hpp; its linear model of small errors is iterated here until the correction
// vanishes). Where a log cannot separate one part from another, or has no turns or no driving, the
// spread becomes large and the part counts as unknown.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

/// A part of the mounting with a larger spread is unknown: it would not improve a map. Fixed,
/// because the limits follow from the matching of maps and not from a robot.
inline constexpr double kLargestMountingSpread_m = 0.05;
inline constexpr double kLargestMountingSpread_rad = 0.035;

/// One part of the mounting.
struct MountingEstimate {
  bool known = false;   ///< false: the log does not show it; the value is unchanged
  double value = 0.0;   ///< m or rad
  double spread = 1.0;  ///< one standard deviation; meaningful without `known` too
};

struct LaserCalibration {
  MountingEstimate x_m;       ///< forward of the odometry's reference point
  MountingEstimate y_m;       ///< to the left of it
  MountingEstimate yaw_rad;   ///< counter-clockwise
  std::size_t with_path = 0;  ///< stretches that contribute to yaw
  std::size_t with_turn = 0;  ///< stretches that contribute to x and y
  std::size_t motions = 0;    ///< used
  std::size_t outlying = 0;   ///< left out

  /// The known parts from the log, the others unchanged.
  [[nodiscard]] geometry::Pose2 T_robot_laser() const {
    return {x_m.value, y_m.value, yaw_rad.value};
  }
};

/// `motions` are motions of the robot, derived from scans with the laser at `T_robot_laser`.
/// `progress`, if set, is called with the number of finished refits. Throws as calibrate_odometry.
LaserCalibration calibrate_laser(
    std::span<const OdometryStretch> stretches, std::span<const MeasuredMotion> motions,
    const geometry::Pose2& T_robot_laser, const OdometryCalibrationConfig& config,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace topogeo::localization
