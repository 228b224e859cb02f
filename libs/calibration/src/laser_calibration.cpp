#include "topogeo/calibration/laser_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// Motions of a frame that sits on the robot at T_robot_measured, as motions of the robot itself.
std::vector<MeasuredMotion> seen_from(std::span<const MeasuredMotion> motions,
                                      const Pose2& T_robot_measured) {
  const Pose2 T_measured_robot = geometry::inverse(T_robot_measured);
  std::vector<MeasuredMotion> moved(motions.begin(), motions.end());
  for (MeasuredMotion& motion : moved) {
    // The lever turns an error of heading into one of position.
    const Pose2 T_robot_measured_last = T_robot_measured * motion.T_first_last;
    const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
    const Eigen::Matrix3d turned = geometry::compose_covariance(
        T_robot_measured, none, motion.T_first_last, motion.covariance);
    motion.covariance =
        geometry::compose_covariance(T_robot_measured_last, turned, T_measured_robot, none);
    motion.T_first_last = T_robot_measured_last * T_measured_robot;
  }
  return moved;
}

Pose2 found_shift(const OdometryCalibration& found) {
  const SystematicErrors& s = found.systematic;
  return {s.ahead_m.value, s.left_m.value, s.yaw_rad.value};
}

/// A part known to `variance` by the bootstrap and the likelihood, whichever is larger.
MountingEstimate part(double value, double before, double variance, double likelihood_variance,
                      double largest_spread) {
  const double spread = std::sqrt(std::max(variance, likelihood_variance));
  const bool known = spread <= largest_spread;
  return {known, known ? value : before, spread};
}

}  // namespace

LaserCalibration calibrate_laser(
    std::span<const OdometryStretch> stretches, std::span<const MeasuredMotion> motions,
    const Pose2& T_robot_laser, const OdometryCalibrationConfig& config,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  // Fixed: the linear model converges in a few rounds; then only rounding is left.
  constexpr int kMostRounds = 30;
  constexpr double kSmallStep = 1e-9;  // m and rad
  OdometryCalibrationConfig quick = config;
  quick.resamples = 2;
  Pose2 T_robot_measured;  // position of the laser relative to its assumed one
  for (int round = 0; round < kMostRounds; ++round) {
    const Pose2 step =
        found_shift(calibrate_odometry(stretches, seen_from(motions, T_robot_measured), quick));
    T_robot_measured = step * T_robot_measured;
    if (step.position_m().norm() + std::fabs(step.theta_rad) < kSmallStep) break;
  }
  const OdometryCalibration found =
      calibrate_odometry(stretches, seen_from(motions, T_robot_measured), config, progress);

  const Pose2 T = found_shift(found) * T_robot_measured * T_robot_laser;
  LaserCalibration result;
  result.yaw_rad = part(T.theta_rad, T_robot_laser.theta_rad, found.mounting_covariance(2, 2),
                        found.mounting_likelihood_covariance(2, 2), kLargestMountingSpread_rad);
  // Turns show the reference point of the odometry as seen from the laser. Its place on the robot
  // depends on the yaw, so it is recomputed if the yaw keeps its previous value.
  const Eigen::Vector2d position_m =
      Pose2{0.0, 0.0, result.yaw_rad.value - T.theta_rad} * T.position_m();
  // First-order motion of a laser at p: (ahead, left) + yaw * (-p.y, p.x).
  Eigen::Matrix3d by_shift = Eigen::Matrix3d::Identity();
  if (result.yaw_rad.known) {
    by_shift(0, 2) = -T.y_m;
    by_shift(1, 2) = T.x_m;
  }
  const auto variances = [&](const Eigen::Matrix3d& covariance) -> Eigen::Vector3d {
    return (by_shift * covariance * by_shift.transpose()).diagonal();
  };
  const Eigen::Vector3d bootstrap = variances(found.mounting_covariance);
  const Eigen::Vector3d likelihood = variances(found.mounting_likelihood_covariance);
  result.x_m = part(position_m.x(), T_robot_laser.x_m, bootstrap[0], likelihood[0],
                    kLargestMountingSpread_m);
  result.y_m = part(position_m.y(), T_robot_laser.y_m, bootstrap[1], likelihood[1],
                    kLargestMountingSpread_m);
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    (kOdometryParameters[p].per_turn ? result.with_turn : result.with_path) =
        found.parameters[p].stretches;
  }
  result.motions = found.motions;
  result.outlying = found.outlying;
  return result;
}

}  // namespace topogeo::localization
