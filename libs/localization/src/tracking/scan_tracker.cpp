#include "topogeo/localization/tracking/scan_tracker.hpp"

#include <Eigen/LU>

#include "topogeo/localization/matching/refinement.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::ScanPoint;

namespace {

// Weight of the earlier scans of a stop in the covariance intersection (Julier and Uhlmann, 1997)
// with the present one: their errors are hardly independent, because all are compared with the same
// scan of the stop. A sum of their information fixed the place along corridors that no scan sees.
constexpr double kEarlierScans = 0.75;

}  // namespace

void ScanTracker::start(std::span<const ScanPoint> points, const Pose2& T_robot_laser,
                        const Pose2& T_odom_robot) {
  T_robot_laser_ = T_robot_laser;
  stop_ = make_reference(extract_scan_features(points, T_robot_laser));
  last_ = {};
  by_odometry_ = {};
  T_odom_last_ = T_odom_robot;
}

void ScanTracker::restart_odometry(const Pose2& T_odom_robot, const Pose2& T_last_robot) {
  constexpr double kSigma_m = 0.1;
  constexpr double kSigma_rad = 0.1;
  last_.covariance +=
      Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
          .asDiagonal();
  last_.T_a_b = last_.T_a_b * T_last_robot;
  by_odometry_ = last_;
  T_odom_last_ = T_odom_robot;
}

TrackedPose ScanTracker::track(std::span<const ScanPoint> points, const Pose2& T_odom_robot) {
  const UncertainPose before = last_;
  UncertainPose step = advance({}, geometry::between(T_odom_last_, T_odom_robot), config_.odometry);
  const Eigen::Matrix3d configured = step.covariance;
  step.covariance = monitor_.widened(configured);
  T_odom_last_ = T_odom_robot;
  last_ = compose(before, step);
  by_odometry_ = compose(by_odometry_, step);
  const UncertainPose predicted{last_.T_a_b, invertible(last_.covariance)};
  const MatchFeatures features = extract_scan_features(points, T_robot_laser_);
  const PosePrior prior = prior_of(predicted);
  const Refinement refined = refine(stop_, features, predicted.T_a_b, prior);
  const Pose2& T = refined.T_reference_query;
  const Eigen::Vector3d error = geometry::difference(T, predicted.T_a_b);
  const bool matched =
      !refined.information.isZero() && refined.overlap >= config_.smallest_overlap &&
      refined.inliers >= config_.smallest_inliers &&
      geometry::squared_mahalanobis(error, predicted.covariance) <= config_.largest_mahalanobis2;
  if (matched) {
    const Eigen::Matrix3d of_step =
        geometry::compose_covariance(before.T_a_b, Eigen::Matrix3d::Zero(), step.T_a_b, configured);
    if (refined.information.determinant() > 0.0) {
      monitor_.add({last_.T_a_b, of_step}, {T, refined.information.inverse() + before.covariance});
    }
    last_ = {T, (refined.information + prior.information).inverse() / (1.0 - kEarlierScans)};
  }
  return {last_.T_a_b, by_odometry_.T_a_b, matched, refined.overlap * refined.inliers};
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
