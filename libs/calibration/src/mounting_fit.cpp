#include "mounting_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Odometry of one motion: a tenth of distance and turn is several times the error of usual wheels,
// and slips beyond are outliers. The constant parts are the play of a base and its time stamps.
constexpr double kOdometry_m = 0.02;
constexpr double kOdometry_rad = 0.02;
constexpr double kOdometryShare = 0.1;
// Lasers are on their robots, most of them within this distance of the centre.
constexpr double kPositionSigma_m = 0.3;
constexpr double kFreedom = 3.0;  // of a motion
// Errors of odometry repeat, so the motions of a good one do not scatter as widely as they err.
constexpr double kLeastScatter = 0.04;

Eigen::Matrix3d odometry_covariance(const Pose2& T_odometry) {
  const double path_m = std::sqrt(T_odometry.position_m().squaredNorm());
  const double turn_rad = std::fabs(T_odometry.theta_rad);
  const double sigma_m = kOdometry_m + kOdometryShare * (path_m + kPositionSigma_m * turn_rad);
  const double sigma_rad = kOdometry_rad + kOdometryShare * (path_m + turn_rad);
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

Pose2 predicted(const Pose2& T_odometry, const Pose2& T_robot_laser) {
  return geometry::inverse(T_robot_laser) * T_odometry * T_robot_laser;
}

/// Inverse covariance of the difference between measured and predicted motion.
Eigen::Matrix3d weight(const LaserMotion& motion, const Pose2& T_robot_laser) {
  const Pose2 T_laser_robot = geometry::inverse(T_robot_laser);
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d turned = geometry::compose_covariance(
      T_laser_robot, none, motion.T_odometry, odometry_covariance(motion.T_odometry));
  const Eigen::Matrix3d of_odometry =
      geometry::compose_covariance(T_laser_robot * motion.T_odometry, turned, T_robot_laser, none);
  return (of_odometry + motion.covariance).inverse();
}

/// Derivative of the predicted motion by the mounting (x, y, yaw).
Eigen::Matrix3d jacobian(const Pose2& T_odometry, const Pose2& T) {
  constexpr double kStep = 1e-6;
  const Pose2 there = predicted(T_odometry, T);
  Eigen::Matrix3d derivative;
  derivative.col(0) =
      geometry::difference(predicted(T_odometry, {T.x_m + kStep, T.y_m, T.theta_rad}), there);
  derivative.col(1) =
      geometry::difference(predicted(T_odometry, {T.x_m, T.y_m + kStep, T.theta_rad}), there);
  derivative.col(2) =
      geometry::difference(predicted(T_odometry, {T.x_m, T.y_m, T.theta_rad + kStep}), there);
  return derivative / kStep;
}

/// Sums over the motions, each with a Cauchy weight.
struct NormalSums {
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

NormalSums linearized(std::span<const LaserMotion> motions, const Pose2& T) {
  NormalSums sums;
  for (const LaserMotion& motion : motions) {
    const Eigen::Vector3d error =
        geometry::difference(motion.T_laser, predicted(motion.T_odometry, T));
    Eigen::Matrix3d information = weight(motion, T);
    information /= 1.0 + error.dot(information * error) / kFreedom;
    const Eigen::Matrix3d by_mounting = jacobian(motion.T_odometry, T);
    sums.hessian += by_mounting.transpose() * information * by_mounting;
    sums.gradient += by_mounting.transpose() * information * error;
  }
  return sums;
}

Eigen::Matrix3d position_prior() {
  constexpr double kInformation = 1.0 / (kPositionSigma_m * kPositionSigma_m);
  return Eigen::Vector3d(kInformation, kInformation, 1e-6).asDiagonal();
}

/// Gauss-Newton for the position and, if wanted, the heading.
MountingFit fitted(std::span<const LaserMotion> motions, Pose2 T, bool with_heading, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    NormalSums sums = linearized(motions, T);
    sums.gradient += position_prior() * Eigen::Vector3d(-T.x_m, -T.y_m, 0.0);
    sums.hessian += position_prior();
    if (!with_heading) sums.hessian(2, 2) += 1e12;
    const Eigen::Vector3d step = sums.hessian.inverse() * sums.gradient;
    T = {T.x_m + step.x(), T.y_m + step.y(), geometry::wrap_angle(T.theta_rad + step.z())};
  }
  return evaluated(motions, T);
}

/// Mean squared error of the motions that fit, in units of the assumed one.
double scatter(const MountingFit& fit) {
  constexpr std::size_t kFewest = 20;  // fewer do not show it
  double sum = 0.0;
  std::size_t count = 0;
  for (const double d2 : fit.squared_mahalanobis) {
    if (d2 > MountingFit::kOutlying) continue;
    sum += d2 / kFreedom;
    ++count;
  }
  return count < kFewest ? 1.0 : sum / static_cast<double>(count);
}

}  // namespace

MountingFit evaluated(std::span<const LaserMotion> motions, const Pose2& T_robot_laser) {
  MountingFit fit;
  fit.T_robot_laser = T_robot_laser;
  fit.squared_mahalanobis.reserve(motions.size());
  for (const LaserMotion& motion : motions) {
    const Eigen::Vector3d error =
        geometry::difference(motion.T_laser, predicted(motion.T_odometry, T_robot_laser));
    fit.squared_mahalanobis.push_back(error.dot(weight(motion, T_robot_laser) * error));
    fit.cost += std::min(fit.squared_mahalanobis.back(), MountingFit::kOutlying);
  }
  return fit;
}

MountingFit fit_position(std::span<const LaserMotion> motions, double yaw_rad) {
  constexpr int kRounds = 4;  // linear, but for the weights
  return fitted(motions, {0.0, 0.0, yaw_rad}, false, kRounds);
}

MountingFit fit_mounting(std::span<const LaserMotion> motions, const Pose2& start) {
  constexpr int kRounds = 10;
  MountingFit fit = fitted(motions, start, true, kRounds);
  const double factor = std::max(scatter(fit), kLeastScatter);
  const Eigen::Matrix3d information = linearized(motions, fit.T_robot_laser).hessian / factor;
  fit.covariance = (information + position_prior()).inverse();
  return fit;
}

}  // namespace topogeo::localization
