// Search for an unknown mounting of the laser: headings all around, upright and upside down, are
// tried on motions of robot and laser (mounting_fit.hpp), and the best counts if enough motions
// speak for it and hardly any for another one. Straight paths show the heading, turns show the
// position and whether the laser hangs upside down. The least squares counts systematic errors of
// the odometry as noise; calibrate_laser, which separates them, needs minutes of driving.
#pragma once

#include <cstddef>
#include <numbers>
#include <span>

#include "topogeo/calibration/laser_motions.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

/// The votes of the motions between a mounting and its best rival of one kind.
struct MountingVotes {
  std::size_t for_it = 0;   ///< motions that fit it and contradict the rival
  std::size_t against = 0;  ///< the other way around

  /// Share of the votes for it by the rule of succession, [0, 1]: 1/2 without votes.
  [[nodiscard]] double confidence() const;
  /// At least kFewest votes and four of five for it.
  [[nodiscard]] bool decided() const;

  /// So many independent motions do not err alike by chance.
  static constexpr std::size_t kFewest = 5;
};

struct FoundMounting {
  /// Headings that differ by as much are rivals; half the angle between two sides of a robot.
  static constexpr double kOtherHeading_rad = std::numbers::pi / 4.0;

  bool heading_known = false;   ///< false: yaw_rad is 0
  bool position_known = false;  ///< false: x and y are 0
  bool upside_down = false;     ///< shown by turns; false without enough of them
  geometry::Pose2 T_robot_laser;
  /// Larger of x and y, one standard deviation, also of a position too uncertain to be known.
  double position_spread_m = 0.0;
  double heading_spread_rad = 0.0;  ///< one standard deviation
  std::size_t motions = 0;          ///< of the drive
  std::size_t fitting = 0;          ///< of those, within the limit of outliers
  MountingVotes heading;            ///< against other headings, 45 degrees or more away
  MountingVotes side;               ///< against the laser on its other side

  /// In [0, 1]: of the less certain of the decisions that were taken; 0 if the heading is unknown.
  [[nodiscard]] double confidence() const;
};

/// The more motions the better; some dozens are enough.
FoundMounting find_mounting(std::span<const LaserMotion> motions);

}  // namespace topogeo::localization
