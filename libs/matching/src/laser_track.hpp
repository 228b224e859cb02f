// Follows a laser from scan to scan without odometry: the last motion goes on (MotionFilter), and
// the scan is compared with the recent ones, point to line. Where the prediction is too uncertain
// for that, as between scans a second apart, an exhaustive search around it finds the place first.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/matching/refinement.hpp"

#include "motion_filter.hpp"
#include "recent_scans.hpp"

namespace topogeo::localization {

/// Input of a track: the features of a scan in the frame of the robot.
struct TimedFeatures {
  std::int64_t stamp_ns = 0;
  std::shared_ptr<const MatchFeatures> features;  ///< never null
};

/// A scan that a track has placed.
struct LaserStep {
  geometry::Pose2 T_track_robot;  ///< in the frame of the first scan of the track
  /// The covariance of the motion since the scan before, in its frame. Along a bare corridor it is
  /// that of the prediction.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double overlap = 0.0;  ///< share of the scan in view of the recent ones, [0, 1]
  /// How far a laser of this speed may have moved, m, since walls last fixed its position; 0 if
  /// this scan fixes it. Between bare walls, the scans before and after fit anywhere along them.
  double unseen_m = 0.0;
};

class LaserTrack {
 public:
  /// Begins at a scan, whose pose is the identity.
  explicit LaserTrack(const TimedFeatures& first);

  /// Whether a scan shows enough to begin a track.
  static bool can_begin(const MatchFeatures& features);

  /// Places the next scan, later than all before. Empty if it does not match the recent scans or
  /// matches in two places; the track then waits for the next one.
  std::optional<LaserStep> add(const TimedFeatures& scan);
  /// The velocity at the last placed scan, m/s forward and left and rad/s.
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return motion_.velocity(); }
  /// Leaves out a scan.
  void skip() { ++scans_; }

 private:
  struct Candidate {
    geometry::Pose2 T_key_robot;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // of the scans alone
    double overlap = 0.0;
    double score = 0.0;  // log-likelihood
  };
  /// The pose of the scan, relative to the newest key scan.
  struct Prediction : UncertainPose {
    bool near = false;  // the refinement finds the place by itself
  };
  [[nodiscard]] std::optional<Candidate> match_at(const MatchFeatures& features,
                                                  const PosePrior& prior,
                                                  const Prediction& predicted) const;
  std::optional<Candidate> best_match(const MatchFeatures& features, const Prediction& predicted);
  LaserStep accept(const TimedFeatures& scan, const Candidate& match,
                   const UncertainPose& predicted);

  RecentScans recent_;
  MotionFilter motion_;
  std::int64_t last_ns_;
  int scans_ = 0;             // since then, that did not match
  double unseen_m_ = 0.0;     // see LaserStep
  UncertainPose T_key_last_;  // last placed scan, relative to the newest key scan
};

}  // namespace topogeo::localization
