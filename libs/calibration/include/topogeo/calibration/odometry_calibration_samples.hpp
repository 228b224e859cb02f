// Input of calibrate_odometry: odometry and measured motions from the local maps of a log.
//
// Without a reference trajectory, single matches between recent stops measure the motions. The
// corrected trajectory would not do, because it contains the odometry itself (every stop depends on
// it, and entirely where a match has little information, as along a bare corridor): residuals
// against it come out too small, and the covariance between two of its poses is unknown. A match
// knows its covariance, and its errors do not add up along the path. For the same reason every
// accepted match is refined once more without the odometry as prior. The corrected trajectory does
// show which matches are wrong. All matches together shaped it, so a match far from it contradicts
// the others, while a slip of the odometry, which must count, shows in all of them alike.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

using LocalMaps = std::vector<std::shared_ptr<const topomap::LocalMap>>;

/// Forwards tasks to another pool and records the accepted matches of a PoseGraphSlam.
class RecordingPool : public MatchPool {
 public:
  struct Match {
    std::uint32_t reference_map_id = 0;
    std::uint32_t query_map_id = 0;
    MatchResult result;  ///< accepted
  };

  /// The pool must outlive this one.
  explicit RecordingPool(MatchPool& pool) : pool_(pool) {}

  void add_map(std::shared_ptr<const topomap::LocalMap> map) override;
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override;

  [[nodiscard]] const std::vector<Match>& accepted() const { return accepted_; }

 private:
  MatchPool& pool_;
  std::vector<Match> accepted_;
};

/// Odometry between successive stops, through all scans in between.
std::vector<OdometryStretch> odometry_stretches(const LocalMaps& maps);

/// Accepted matches as measured motions. `trajectory` is the result of SLAM.
struct MatchedMotions {
  std::vector<MeasuredMotion> motions;
  std::size_t unrefined = 0;     ///< left out: the scans alone do not determine the pose
  std::size_t contradicted = 0;  ///< left out: far from the poses that all matches together give
};
MatchedMotions motions_from_matches(const LocalMaps& maps,
                                    std::span<const RecordingPool::Match> matches,
                                    const topomap::Trajectory& trajectory);

/// Motions from every stop to some of the stops at most `longest_path_m` of odometry later,
/// measured by a trajectory of the robot in time order. A stop is interpolated between two poses of
/// the trajectory at most 0.5 s apart; other stops are left out. The stated deviations are 2 cm and
/// 0.3 degrees, the floor of matches.
std::vector<MeasuredMotion> motions_from_reference(const LocalMaps& maps,
                                                   std::span<const topomap::StampedPose> reference,
                                                   double longest_path_m);

}  // namespace topogeo::localization
