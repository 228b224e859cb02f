#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/calibration/mounting_search.hpp"
#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Scans closer together show no more, and take time.
constexpr double kScanStep_m = 0.1;
constexpr double kScanStep_rad = 0.1;
// Longer motions show the direction better, but fewer scans still show the same surfaces. A robot
// in a small room makes some dozens of these.
constexpr double kMotion_m = 0.4;
constexpr double kMotion_rad = 0.4;
// The least squares finds the pose from within half a metre and a quarter of a radian.
constexpr double kSameStart_m = 0.25;
constexpr double kSameStart_rad = 0.15;
// Higher than in the tracking of scans, because no prior corrects a bad fit.
constexpr double kLeastOverlap = 0.5;
constexpr double kLeastInliers = 0.6;

double length_m(const Pose2& step) {
  return std::sqrt(step.position_m().squaredNorm());
}

bool is_motion(const Pose2& step, double distance_m, double turn_rad) {
  return length_m(step) >= distance_m || std::fabs(step.theta_rad) >= turn_rad;
}

double quality(const Refinement& fit) {
  return fit.overlap * fit.inliers * (1.0 - fit.violations);
}

/// Starts for a laser that was at T_laser before the robot's step: where it was, then the step in
/// each direction, turned to each side.
std::vector<Pose2> starts(const Pose2& T_laser, const Pose2& step) {
  std::vector<Pose2> found;
  const auto add = [&](const Pose2& T_step) {
    const Pose2 T = T_laser * T_step;
    const bool tried = std::ranges::any_of(found, [&](const Pose2& other) {
      const Eigen::Vector3d apart = geometry::difference(T, other);
      return apart.head<2>().norm() < kSameStart_m && std::fabs(apart.z()) < kSameStart_rad;
    });
    if (!tried) found.push_back(T);
  };
  add({});
  for (const double side : {1.0, -1.0}) {
    add({0.0, 0.0, side * step.theta_rad});
    for (const double quarter : {0.0, 1.0, 2.0, 3.0}) {
      const Eigen::Vector2d ahead_m =
          Pose2{0.0, 0.0, quarter * std::numbers::pi / 2.0} * step.position_m();
      add({ahead_m.x(), ahead_m.y(), side * step.theta_rad});
    }
  }
  return found;
}

Eigen::Matrix3d covariance_of(const Refinement& fit) {
  MatchResult match;
  match.overlap = fit.overlap;
  match.inliers = fit.inliers;
  match.violations = fit.violations;
  match.residual_rms_m = fit.residual_rms_m;
  match.scan_fitness = 1.0;  // no doubt by a fitness that was not computed
  return match_covariance(fit.information, doubt(match));
}

}  // namespace

LaserMotion mirrored(const LaserMotion& motion) {
  LaserMotion seen = motion;
  seen.T_laser = {motion.T_laser.x_m, -motion.T_laser.y_m, -motion.T_laser.theta_rad};
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  seen.covariance = mirror * motion.covariance * mirror;
  return seen;
}

void LaserMotions::add(std::span<const topomap::ScanPoint> points, std::int64_t stamp_ns,
                       const Pose2& T_odom_robot, std::uint64_t odometry_epoch) {
  const bool follows = first_ && odometry_epoch == epoch_;
  epoch_ = odometry_epoch;
  const Pose2 step = geometry::between(T_odom_last_, T_odom_robot);
  if (follows && !is_motion(step, kScanStep_m, kScanStep_rad)) return;
  MatchFeatures features = extract_scan_features(points, Pose2{});
  const std::optional<Refinement> fit = follows ? best_fit(features, step) : std::nullopt;
  if (!fit) return begin(std::move(features), stamp_ns, T_odom_robot);
  T_odom_last_ = T_odom_robot;
  motion_.odometry.push_back(step);
  motion_.T_odometry = motion_.T_odometry * step;
  motion_.T_laser = fit->T_reference_query;
  if (!is_motion(motion_.T_odometry, kMotion_m, kMotion_rad)) return;
  motion_.covariance = covariance_of(*fit);
  motion_.last_ns = stamp_ns;
  motions_.push_back(motion_);
  begin(std::move(features), stamp_ns, T_odom_robot);
}

void LaserMotions::begin(MatchFeatures features, std::int64_t stamp_ns, const Pose2& T_odom_robot) {
  first_ = make_reference(std::move(features));
  T_odom_last_ = T_odom_robot;
  motion_ = {};
  motion_.first_ns = stamp_ns;
}

std::optional<Refinement> LaserMotions::best_fit(const MatchFeatures& features,
                                                 const Pose2& step) const {
  std::optional<Refinement> best;
  for (const Pose2& start : starts(motion_.T_laser, step)) {
    const Refinement fit = refine(*first_, features, start, {});
    if (fit.information.isZero(0.0) || fit.overlap < kLeastOverlap || fit.inliers < kLeastInliers) {
      continue;
    }
    if (!best || quality(fit) > quality(*best)) best = fit;
  }
  return best;
}

}  // namespace topogeo::localization
