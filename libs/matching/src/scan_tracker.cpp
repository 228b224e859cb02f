#include "topogeo/matching/scan_tracker.hpp"

#include <cmath>

#include <Eigen/LU>

#include "topogeo/matching/refinement.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::ScanPoint;

namespace {

// Weight of the earlier scans of a stop in the covariance intersection (Julier and Uhlmann, 1997)
// with the present one: their errors are hardly independent, because all are compared with the same
// scan of the stop. A sum of their information fixed the place along corridors that no scan sees.
constexpr double kEarlierScans = 0.75;

// Conditions on a match that contradicts odometry: those of a LaserTrack after a search, and nearly
// the whole scan in view, because the robot is where it was.
constexpr double kLeastOverlapAgainst = 0.8;
constexpr double kLeastInliersAgainst = 0.9;
constexpr double kMostViolationsAgainst = 0.1;
// The reach of the refinement around the last matched scan.
constexpr double kAround_m = 0.25;
constexpr double kAround_rad = 0.1;
// Rolling wheels err by less, besides the jitter of stamps, and a match is that much surer.
constexpr double kJitter_m = 0.05;
constexpr double kJitter_rad = 0.1;
constexpr double kWheelShare = 0.5;
constexpr double kContradictionSigmas = 5.0;
// After a contradiction, odometry counts for little over so many scans.
constexpr int kDistrustedScans = 5;
constexpr double kDistrust_m = 0.2;
constexpr double kDistrust_rad = 0.1;

bool stands(const Pose2& odometry) {
  constexpr double kStands_m = 0.02;
  constexpr double kStands_rad = 0.02;
  return odometry.position_m().norm() < kStands_m && std::fabs(odometry.theta_rad) < kStands_rad;
}

/// Error of rolling wheels in a step, at most, m.
double largest_error_m(const Pose2& odometry) {
  return kJitter_m + kWheelShare * odometry.position_m().norm();
}

/// Whether the scans alone exclude the pose by odometry, `off` away, after a step by odometry. A
/// wrong heading of rolling wheels is left to the wider search of the next stop.
bool contradicts(const Eigen::Vector3d& off, const Eigen::Matrix3d& information,
                 const Pose2& odometry) {
  const Eigen::Matrix3d covariance = invertible(information.inverse());
  const auto is_beyond = [&](const Eigen::Vector3d& part, double least) {
    constexpr double kSigmas2 = kContradictionSigmas * kContradictionSigmas;
    const double squared = part.squaredNorm();
    return squared >= least * least && squared * squared >= kSigmas2 * part.dot(covariance * part);
  };
  return is_beyond({off.x(), off.y(), 0.0}, largest_error_m(odometry)) ||
         (stands(odometry) && is_beyond({0.0, 0.0, off.z()}, kJitter_rad));
}

}  // namespace

void ScanTracker::start(std::span<const ScanPoint> points, const Pose2& T_robot_laser,
                        const Pose2& T_odom_robot) {
  T_robot_laser_ = T_robot_laser;
  stop_ = make_reference(extract_scan_features(points, T_robot_laser));
  last_ = {};
  by_odometry_ = {};
  T_stop_matched_ = {};
  T_odom_matched_ = T_odom_robot;
  T_odom_last_ = T_odom_robot;
  distrusted_scans_ = 0;
}

void ScanTracker::restart_odometry(const Pose2& T_odom_robot, const Pose2& T_last_robot) {
  constexpr double kSigma_m = 0.1;
  constexpr double kSigma_rad = 0.1;
  last_.covariance +=
      Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
          .asDiagonal();
  last_.T_a_b = last_.T_a_b * T_last_robot;
  by_odometry_ = last_;
  T_stop_matched_ = last_.T_a_b;
  T_odom_matched_ = T_odom_robot;
  T_odom_last_ = T_odom_robot;
}

TrackedPose ScanTracker::track(std::span<const ScanPoint> points, const Pose2& T_odom_robot) {
  const UncertainPose before = last_;
  UncertainPose step = advance({}, geometry::between(T_odom_last_, T_odom_robot), config_.odometry);
  const Eigen::Matrix3d configured = step.covariance;
  step.covariance = monitor_.widened(configured);
  if (distrusted_scans_ > 0) {
    --distrusted_scans_;
    step.covariance +=
        Eigen::Vector3d(kDistrust_m, kDistrust_m, kDistrust_rad).cwiseAbs2().asDiagonal();
  }
  T_odom_last_ = T_odom_robot;
  last_ = compose(before, step);
  by_odometry_ = compose(by_odometry_, step);
  const UncertainPose predicted{last_.T_a_b, invertible(last_.covariance)};
  const MatchFeatures features = extract_scan_features(points, T_robot_laser_);
  const PosePrior prior = prior_of(predicted);
  const Refinement refined = refine(stop_, features, predicted.T_a_b, prior);
  const Pose2& T = refined.T_reference_query;
  const Eigen::Vector3d error = geometry::difference(T, predicted.T_a_b);
  const Pose2 rolled = geometry::between(T_odom_matched_, T_odom_robot);
  const bool matched =
      !refined.information.isZero() && refined.overlap >= config_.smallest_overlap &&
      refined.inliers >= config_.smallest_inliers &&
      geometry::squared_mahalanobis(error, predicted.covariance) <= config_.largest_mahalanobis2;
  // While the wheels stand, the prior is so strong that a scan of another place may seem to match.
  std::optional<Refinement> against;
  if (!matched || (stands(rolled) && refined.inliers < kLeastInliersAgainst)) {
    against = match_against(features, predicted);
  }
  if (against) {
    T_stop_matched_ = against->T_reference_query;
    T_odom_matched_ = T_odom_robot;
    distrusted_scans_ = kDistrustedScans;
    last_ = {T_stop_matched_, against->information.inverse()};
    by_odometry_ = last_;
    return {last_.T_a_b, by_odometry_.T_a_b, true, true, against->overlap * against->inliers};
  }
  if (matched) {
    const Eigen::Matrix3d of_step =
        geometry::compose_covariance(before.T_a_b, Eigen::Matrix3d::Zero(), step.T_a_b, configured);
    if (refined.information.determinant() > 0.0) {
      monitor_.add({last_.T_a_b, of_step}, {T, refined.information.inverse() + before.covariance});
    }
    last_ = {T, (refined.information + prior.information).inverse() / (1.0 - kEarlierScans)};
    const Eigen::Vector3d off = geometry::difference(geometry::between(T_stop_matched_, T), rolled);
    if (distrusted_scans_ > 0 && off.head<2>().norm() > largest_error_m(rolled)) {
      distrusted_scans_ = kDistrustedScans;
      by_odometry_ = last_;
    }
    T_stop_matched_ = T;
    T_odom_matched_ = T_odom_robot;
  }
  return {last_.T_a_b, by_odometry_.T_a_b, matched, false, refined.overlap * refined.inliers};
}

std::optional<Refinement> ScanTracker::match_against(const MatchFeatures& features,
                                                     const UncertainPose& predicted) const {
  const Eigen::Matrix3d around =
      Eigen::Vector3d(kAround_m, kAround_m, kAround_rad).cwiseAbs2().cwiseInverse().asDiagonal();
  const Refinement match = refine(stop_, features, T_stop_matched_, {T_stop_matched_, around});
  if (match.information.determinant() <= 0.0 || match.overlap < kLeastOverlapAgainst ||
      match.inliers < kLeastInliersAgainst || match.violations > kMostViolationsAgainst) {
    return std::nullopt;
  }
  const Eigen::Vector3d off = geometry::difference(predicted.T_a_b, match.T_reference_query);
  if (!contradicts(off, match.information, geometry::between(T_odom_matched_, T_odom_last_))) {
    return std::nullopt;
  }
  return match;
}

// Joined with the match of a scan: the odometry since the stop, and the prediction, which holds the
// matches of the earlier scans. The weights are divided by that of the scan, so that its match
// counts whole in the refinement.
PosePrior ScanTracker::prior_of(const UncertainPose& predicted) const {
  const Eigen::Matrix3d of_odometry = invertible(by_odometry_.covariance).inverse();
  const Eigen::Matrix3d of_earlier =
      kEarlierScans / (1.0 - kEarlierScans) * predicted.covariance.inverse();
  const Eigen::Matrix3d both = of_odometry + of_earlier;
  const Eigen::Vector3d shift =
      both.inverse() * of_odometry * geometry::difference(by_odometry_.T_a_b, predicted.T_a_b);
  const Pose2& T = predicted.T_a_b;
  return {{T.x_m + shift.x(), T.y_m + shift.y(), geometry::wrap_angle(T.theta_rad + shift.z())},
          both};
}

}  // namespace topogeo::localization
