// Search for an unknown mounting of the laser: headings all around, upright and upside down, are
// tried on motions of robot and laser (mounting_fit.hpp), and the best counts if enough motions
// speak for it and hardly any for another one. Straight paths show the heading, turns show the
// position and whether the laser hangs upside down. The least squares counts systematic errors of
// the odometry as noise; calibrate_laser, which separates them, needs minutes of driving.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

// Motions of a laser from its scans, beside those of the robot by odometry, for a laser whose
// mounting is unknown.
//
// Scans are compared in the frame of the laser. The odometry only proposes where to start: the
// laser may look in any direction and may hang upside down, so the step of the robot is tried in
// the four directions of a laser and with its turn to both sides, and the best fit counts. No
// prior enters the result.

/// A motion of some decimetres, or of a turn, between two scans.
struct LaserMotion {
  OdometryStretch odometry;    ///< steps of the robot from the first scan to the last
  geometry::Pose2 T_odometry;  ///< the steps together
  geometry::Pose2 T_laser;     ///< last pose of the laser in its first; x along the beam at angle 0
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of T_laser, in the first frame
  std::int64_t first_ns = 0;                                 ///< stamps of the two scans
  std::int64_t last_ns = 0;
};

/// The same motion for a laser that is upside down: seen from above, its scans are mirrored.
LaserMotion mirrored(const LaserMotion& motion);

class LaserMotions {
 public:
  /// The next scan in time order: its points in the frame of the laser, m, its stamp and the
  /// odometry. Poses of different epochs are unrelated.
  void add(std::span<const topomap::ScanPoint> points, std::int64_t stamp_ns,
           const geometry::Pose2& T_odom_robot, std::uint64_t odometry_epoch);

  /// Motions one after the other, without overlap.
  [[nodiscard]] const std::vector<LaserMotion>& motions() const { return motions_; }

 private:
  void begin(MatchFeatures features, std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);
  [[nodiscard]] std::optional<Refinement> best_fit(const MatchFeatures& features,
                                                   const geometry::Pose2& step) const;

  std::optional<Reference> first_;  // scan at which the motion begins
  std::uint64_t epoch_ = 0;
  geometry::Pose2 T_odom_last_;
  LaserMotion motion_;  // so far
  std::vector<LaserMotion> motions_;
};

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
