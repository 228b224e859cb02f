#include "topogeo/localization/tracking/scan_tracker.hpp"

#include <Eigen/LU>

#include "topogeo/localization/matching/refinement.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::ScanPoint;

void ScanTracker::start(std::span<const ScanPoint> points, const Pose2& T_robot_laser,
                        const Pose2& T_odom_robot) {
  T_robot_laser_ = T_robot_laser;
  stop_ = make_reference(extract_scan_features(points, T_robot_laser));
  last_ = {};
  T_odom_last_ = T_odom_robot;
}

void ScanTracker::restart_odometry(const Pose2& T_odom_robot, const Pose2& T_last_robot) {
  constexpr double kSigma_m = 0.1;
  constexpr double kSigma_rad = 0.1;
  last_.covariance +=
      Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
          .asDiagonal();
  last_.T_a_b = last_.T_a_b * T_last_robot;
  T_odom_last_ = T_odom_robot;
}

TrackedPose ScanTracker::track(std::span<const ScanPoint> points, const Pose2& T_odom_robot) {
  const UncertainPose before = last_;
  const UncertainPose step =
      advance({}, geometry::between(T_odom_last_, T_odom_robot), config_.odometry);
  T_odom_last_ = T_odom_robot;
  last_ = {before.T_a_b * step.T_a_b,
           geometry::compose_covariance(before.T_a_b, before.covariance, step.T_a_b,
                                        monitor_.widened(step.covariance))};
  const PosePrior prior{last_.T_a_b, invertible(last_.covariance).inverse()};
  const MatchFeatures features = extract_scan_features(points, T_robot_laser_);
  const Refinement refined = refine(stop_, features, last_.T_a_b, prior);
  const Pose2& T = refined.T_reference_query;
  const Eigen::Vector3d error = geometry::difference(T, last_.T_a_b);
  const bool matched = !refined.information.isZero() &&
                       refined.overlap >= config_.smallest_overlap &&
                       refined.inliers >= config_.smallest_inliers &&
                       error.dot(prior.information * error) <= config_.largest_mahalanobis2;
  if (matched) {
    const Eigen::Matrix3d of_step = geometry::compose_covariance(
        before.T_a_b, Eigen::Matrix3d::Zero(), step.T_a_b, step.covariance);
    if (refined.information.determinant() > 0.0) {
      monitor_.add({last_.T_a_b, of_step}, {T, refined.information.inverse() + before.covariance});
    }
    last_.T_a_b = T;
    last_.covariance = (refined.information + prior.information).inverse();
  }
  return {last_.T_a_b, matched, refined.overlap * refined.inliers};
}

}  // namespace topogeo::localization
