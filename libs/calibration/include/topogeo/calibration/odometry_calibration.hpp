// Estimates the OdometryNoise parameters of a robot from a log (docs/algorithms.md, "Calibration of
// odometry and laser"), using motions whose odometry and true motion are both known.
//
// The residual of a motion is its odometry minus its measurement, in the frame of its first pose.
// Its covariance is linear in the parameters (the sum that `advance` makes of all steps) plus the
// covariance of the measurement, so the parameters maximise the likelihood of normally distributed
// residuals. Motions of different length separate noise that grows with distance or turn from the
// noise of every measurement. One factor, estimated too, scales the stated covariances of the
// measurements, because neither matches nor reference trajectories know theirs exactly. The search
// starts from a fit with Student's t distribution, so that outlying measurements do not lead it,
// and leaves out motions beyond `largest_mahalanobis2`.
//
// Every parameter is estimated twice. `as_is` counts systematic errors (a wrong wheel diameter, a
// drift to one side) as noise: a localizer has to expect this noise from the odometry today, and it
// belongs in the configuration. `corrected` is the noise left after the systematic errors, which
// are estimated as well, have been taken out of the odometry.
//
// A value that cannot be distinguished from zero is given as its upper end: too little noise makes
// a localizer search in the wrong place, too much only costs it time.
//
// Motions overlap and errors of successive matches are correlated, so the spread comes from refits
// to random choices of blocks of the log (block bootstrap) and not from the likelihood.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/calibration/odometry_calibration_config.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// Steps of odometry (T_before_after) from one stop to the next.
using OdometryStretch = std::vector<geometry::Pose2>;

/// The relative pose of two stops, measured by something other than odometry.
struct MeasuredMotion {
  std::uint32_t first = 0;  ///< stop; stretch i leads from stop i to stop i + 1
  std::uint32_t last = 0;   ///< > first
  geometry::Pose2 T_first_last;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity();  ///< of T_first_last, in the frame of `first`
};

/// A field of OdometryNoise.
struct NoiseParameter {
  const char* key;  ///< below "odometry." in the configuration
  const char* unit;
  double OdometryNoise::*field;
  bool per_turn;  ///< grows with the turn; otherwise with the distance
};

inline constexpr std::size_t kNoiseParameters = 5;

/// In the order of the configuration file.
extern const std::array<NoiseParameter, kNoiseParameters> kOdometryParameters;

struct Estimate {
  double value = 0.0;
  double spread = 0.0;  ///< one standard deviation
  bool at_most =
      false;  ///< not distinguishable from 0; `value` then is one spread above the estimate
};

struct NoiseEstimate {
  bool known = false;         ///< false: the log does not show it, both values are `fallback`
  std::size_t stretches = 0;  ///< with enough distance (0.2 m) or turn (0.2 rad) to count
  Estimate as_is;             ///< with systematic errors counted as noise
  Estimate corrected;         ///< without them
};

/// Errors of odometry that repeat. Positive: the odometry measures too much.
struct SystematicErrors {
  Estimate distance;           ///< per metre driven: 0.02 where 1 m is measured as 1.02 m
  Estimate heading_rad_per_m;  ///< counter-clockwise turn measured on a straight path
  Estimate turn;               ///< per radian of turn, as `distance`; 0 +- 0 in a log without turns
  // Position of the laser (the sensor of the measurements) relative to its assumed position on the
  // robot. The first two are 0 +- 0 without turns, the last is without driving.
  Estimate ahead_m;
  Estimate left_m;
  Estimate yaw_rad;  ///< counter-clockwise
};

struct OdometryCalibration {
  OdometryNoise noise;  ///< the `as_is` values
  std::array<NoiseEstimate, kNoiseParameters> parameters;
  SystematicErrors systematic;
  /// Covariance of (ahead, left, yaw) in `systematic`, m and rad: by the bootstrap, and by the
  /// likelihood alone. The second is close to 1 where the log shows nothing. The first cannot show
  /// that, because without data all resamples agree on 0.
  Eigen::Matrix3d mounting_covariance = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d mounting_likelihood_covariance = Eigen::Matrix3d::Identity();
  std::size_t motions = 0;         ///< used
  std::size_t outlying = 0;        ///< left out of the `as_is` fit
  double measurement_scale = 1.0;  ///< estimated over stated deviations of the measurements
};

/// Fewest contributing stretches from which a parameter is estimated. Fixed: with fewer the
/// bootstrap has no blocks to choose from.
inline constexpr std::size_t kFewestStretches = 20;

/// `progress`, if set, is called with the number of finished refits. Throws std::invalid_argument
/// if a setting is out of range, a motion names no stretch, or its pose or covariance is invalid;
/// std::runtime_error if the motions cover fewer than `kFewestStretches` stretches or nothing
/// moves.
OdometryCalibration calibrate_odometry(
    std::span<const OdometryStretch> stretches, std::span<const MeasuredMotion> motions,
    const OdometryCalibrationConfig& config,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

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
