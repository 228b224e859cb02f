// Tracks the robot from scan to scan between two stops: each scan is compared with the scan of the
// last stop (point to line, with the odometry as prior), so errors do not add up from scan to scan.
// A direction that the walls do not determine, along a bare corridor, is left to the odometry.
//
// Where a scan does not match at the place by odometry, but does beyond doubt where the last one
// was, the scans decide: the wheels have spun, or the robot was carried.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/match_config.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/matching/odometry_monitor.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

struct TrackedPose {
  geometry::Pose2 T_stop_robot;
  geometry::Pose2 T_stop_odometry;  ///< by the odometry since the stop alone
  bool matched = false;             ///< false: only odometry since the last matched scan
  bool against_odometry = false;    ///< matched where odometry cannot have brought the robot
  double agreement = 0.0;           ///< share of the scan in the stop's view that fits it, [0, 1]
};

class ScanTracker {
 public:
  explicit ScanTracker(ScanTrackerConfig config) : config_(config) {}

  /// Restarts at a stop: its scan points in the robot frame and its odometry.
  void start(std::span<const topomap::ScanPoint> points, const geometry::Pose2& T_robot_laser,
             const geometry::Pose2& T_odom_robot);

  /// The odometry restarts with the next scan, taken about at this pose relative to the last one.
  void restart_odometry(const geometry::Pose2& T_odom_robot, const geometry::Pose2& T_last_robot);

  /// Places the next scan relative to the stop. Call start() first.
  TrackedPose track(std::span<const topomap::ScanPoint> points,
                    const geometry::Pose2& T_odom_robot);

 private:
  [[nodiscard]] PosePrior prior_of(const UncertainPose& predicted) const;
  /// The pose by the scans alone, near the last matched scan, if odometry cannot be right.
  [[nodiscard]] std::optional<Refinement> match_against(const MatchFeatures& features,
                                                        const UncertainPose& predicted) const;

  ScanTrackerConfig config_;
  geometry::Pose2 T_robot_laser_;
  Reference stop_;
  UncertainPose last_;              // pose of the last scan in the frame of the stop
  UncertainPose by_odometry_;       // the same by the odometry since the stop alone
  geometry::Pose2 T_stop_matched_;  // pose of the last matched scan ...
  geometry::Pose2 T_odom_matched_;  // ... and its odometry
  int distrusted_scans_ = 0;        // that follow with little trust in odometry
  geometry::Pose2 T_odom_last_;
  OdometryMonitor monitor_;
};

}  // namespace topogeo::localization
