#include "motion_mounting.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/LU>

namespace topogeo::scan {
namespace {

using geometry::Pose2;

// The same as in the search by scans (docs/decisions/unknown_mounting.md).
constexpr double kMotion_m = 0.4;
constexpr double kMotion_rad = 0.4;
// A larger difference of the turns is a correction of the trajectory, as where a loop closes.
constexpr double kSameTurn_rad = 0.1;
constexpr double kStraight_rad = 0.05;
constexpr double kTurning_rad = 0.3;
constexpr std::size_t kFewest = 10;  // fewer agree by chance
constexpr double kFits_m = 0.05;
constexpr double kFitting = 0.9;
constexpr double kLeast_m = 0.05;
constexpr double kLeast_rad = 5.0 * std::numbers::pi / 180.0;
constexpr double kSameHeading_rad = 2.0 * std::numbers::pi / 180.0;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double direction_rad(const Pose2& motion) {
  return std::atan2(motion.y_m, motion.x_m);
}

/// (R - I) of a turn.
Eigen::Matrix2d swing(double turn_rad) {
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  Eigen::Matrix2d matrix;
  matrix << c - 1.0, -s, s, c - 1.0;
  return matrix;
}

}  // namespace

void MotionMounting::add(const LinePoses& poses) {
  if (!first_) {
    first_ = poses;
    return;
  }
  const Motion motion{between(first_->T_odom_robot, poses.T_odom_robot),
                      between(first_->T_odom_laser, poses.T_odom_laser)};
  const double length_m = motion.robot.position_m().norm();
  if (length_m < kMotion_m && std::fabs(motion.robot.theta_rad) < kMotion_rad) return;
  first_ = poses;
  if (std::fabs(geometry::wrap_angle(motion.robot.theta_rad - motion.laser.theta_rad)) <=
      kSameTurn_rad) {
    motions_.push_back(motion);
  }
}

/// The heading of the laser by the straight motions; empty with too few of them.
std::optional<double> MotionMounting::heading_rad() const {
  std::vector<double> sines;
  std::vector<double> cosines;
  for (const Motion& motion : motions_) {
    if (std::fabs(motion.robot.theta_rad) > kStraight_rad) continue;
    if (motion.laser.position_m().norm() < 0.5 * kMotion_m) continue;
    const double apart_rad = direction_rad(motion.robot) - direction_rad(motion.laser);
    sines.push_back(std::sin(apart_rad));
    cosines.push_back(std::cos(apart_rad));
  }
  if (sines.size() < kFewest) return std::nullopt;
  return std::atan2(median_of(std::move(sines)), median_of(std::move(cosines)));
}

std::optional<Pose2> MotionMounting::find() const {
  const auto turning = std::ranges::count_if(motions_, [](const Motion& motion) {
    return std::fabs(motion.robot.theta_rad) >= kTurning_rad;
  });
  std::optional<double> yaw_rad = heading_rad();
  if (!yaw_rad || turning < static_cast<std::ptrdiff_t>(kFewest)) return std::nullopt;
  if (std::fabs(*yaw_rad) < kSameHeading_rad) yaw_rad = 0.0;
  const Pose2 T_turned{0.0, 0.0, *yaw_rad};
  const auto wanted_m = [&](const Motion& motion) -> Eigen::Vector2d {
    return (T_turned * motion.laser).position_m() - motion.robot.position_m();
  };
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  const auto error_m = [&](const Motion& motion) {
    return (swing(motion.robot.theta_rad) * position_m - wanted_m(motion)).norm();
  };
  constexpr int kRounds = 10;  // linear, but for the Cauchy weights
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d hessian = 1e-9 * Eigen::Matrix2d::Identity();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    for (const Motion& motion : motions_) {
      const double relative = round == 0 ? 0.0 : error_m(motion) / kFits_m;
      const double weight = 1.0 / (1.0 + relative * relative);
      const Eigen::Matrix2d by_position = swing(motion.robot.theta_rad);
      hessian += weight * by_position.transpose() * by_position;
      gradient += weight * by_position.transpose() * wanted_m(motion);
    }
    position_m = hessian.inverse() * gradient;
  }
  const auto fitting = std::ranges::count_if(
      motions_, [&](const Motion& motion) { return error_m(motion) <= kFits_m; });
  const bool fits = static_cast<double>(fitting) >= kFitting * static_cast<double>(motions_.size());
  const bool apart = position_m.norm() >= kLeast_m || std::fabs(*yaw_rad) >= kLeast_rad;
  if (!fits || !apart) return std::nullopt;
  return Pose2{position_m.x(), position_m.y(), *yaw_rad};
}

}  // namespace topogeo::scan
