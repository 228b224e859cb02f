// Motions of a laser from its scans, beside those of the robot by odometry, for a laser whose
// mounting is unknown.
//
// Scans are compared in the frame of the laser. The odometry only proposes where to start: the
// laser may look in any direction and may hang upside down, so the step of the robot is tried in
// the four directions of a laser and with its turn to both sides, and the best fit counts. No
// prior enters the result.
#pragma once

#include <cstdint>
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

/// A motion of some decimetres, or of a turn, between two scans.
struct LaserMotion {
  OdometryStretch odometry;    ///< steps of the robot from the first scan to the last
  geometry::Pose2 T_odometry;  ///< the steps together
  geometry::Pose2 T_laser;     ///< last pose of the laser in its first; x along the beam at angle 0
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of T_laser, in the first frame
};

/// The same motion for a laser that is upside down: seen from above, its scans are mirrored.
LaserMotion mirrored(const LaserMotion& motion);

class LaserMotions {
 public:
  /// The next scan in time order: its points in the frame of the laser, m, and the odometry. Poses
  /// of different epochs are unrelated.
  void add(std::span<const topomap::ScanPoint> points, const geometry::Pose2& T_odom_robot,
           std::uint64_t odometry_epoch);

  /// Motions one after the other, without overlap.
  [[nodiscard]] const std::vector<LaserMotion>& motions() const { return motions_; }

 private:
  void begin(MatchFeatures features, const geometry::Pose2& T_odom_robot);
  [[nodiscard]] std::optional<Refinement> best_fit(const MatchFeatures& features,
                                                   const geometry::Pose2& step) const;

  std::optional<Reference> first_;  // scan at which the motion begins
  std::uint64_t epoch_ = 0;
  geometry::Pose2 T_odom_last_;
  LaserMotion motion_;  // so far
  std::vector<LaserMotion> motions_;
};

}  // namespace topogeo::localization
