// What calibrate_odometry works on, from the local maps of a log and a yardstick for its motions.
//
// Without a reference trajectory the yardstick is single matches between recent stops, not the
// corrected trajectory: that contains the odometry itself (every stop hangs on it, and where a
// match knows little, along a bare corridor, on nothing else), so residuals against it come out too
// small, and the covariance between two of its poses is not known. A match knows its own, and its
// errors do not add up along the path. For the same reason every accepted match is refined once
// more without the odometry as prior. The corrected trajectory does show which matches are wrong:
// all of them together have shaped it, so a match far from it stands against the others, while a
// slip of the odometry, which must count, shows in all of them alike.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/localization/calibration/odometry_calibration.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

using LocalMaps = std::vector<std::shared_ptr<const topomap::LocalMap>>;

/// Hands tasks on to another pool and keeps the accepted matches, for a Localizer that is to be
/// watched.
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

/// Odometry between successive stops, through all scans between.
std::vector<OdometryStretch> odometry_stretches(const LocalMaps& maps);

/// Accepted matches as measured motions. `trajectory` is what the localizer made of them.
struct MatchedMotions {
  std::vector<MeasuredMotion> motions;
  std::size_t unrefined = 0;     ///< left out: the scans alone do not fix the pose
  std::size_t contradicted = 0;  ///< left out: far from where all matches together put the stops
};
MatchedMotions motions_from_matches(const LocalMaps& maps,
                                    std::span<const RecordingPool::Match> matches,
                                    const topomap::Trajectory& trajectory);

/// Motions from every stop to some of those up to `longest_path_m` of odometry on, by a trajectory
/// of the robot in time order. A stop between two of its poses that are at most 0.5 s apart is
/// interpolated; other stops are left out. The stated deviations are 2 cm and 0.3 degrees, as the
/// floor of matches.
std::vector<MeasuredMotion> motions_from_reference(const LocalMaps& maps,
                                                   std::span<const topomap::StampedPose> reference,
                                                   double longest_path_m);

}  // namespace topogeo::localization
