#include "topogeo/matching/odometry_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::localization {

namespace {

// A step with a larger ratio to its variance is a blow or a wrong match, not noise: it counts, but
// cannot widen the next twenty steps on its own.
constexpr double kLargestRatio = 100.0;
// Six times the configured deviation: worse odometry is of no use.
constexpr double kLargestFactor = 36.0;
// Limits of expected(): no odometry is better than a fifth of the configured deviation for long,
// and three times the variance of the last steps covers their common errors.
constexpr double kLeastExpected = 0.04;
constexpr double kMargin = 3.0;

Eigen::Matrix3d scaled(const Eigen::Matrix3d& covariance, double translation, double heading) {
  const double along = std::sqrt(translation);
  const double turn = std::sqrt(heading);
  const Eigen::Vector3d scale(along, along, turn);
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace

void OdometryMonitor::Ratio::add(double squared, double odometry_variance, double match_variance) {
  if (!(odometry_variance > 0.0)) return;  // a standing robot
  const double noise = std::max(0.0, squared - match_variance);
  const double ratio = std::min(noise / odometry_variance, kLargestRatio);
  // An uncertain match tells little about odometry.
  const double certainty = odometry_variance / (odometry_variance + match_variance);
  constexpr double kFading = 1.0 - 1.0 / kMemory;
  weighted_ = kFading * weighted_ + certainty * ratio;
  weight_ = kFading * weight_ + certainty;
}

double OdometryMonitor::Ratio::factor() const {
  return std::clamp(weighted_ / weight_, 1.0, kLargestFactor);
}

void OdometryMonitor::add(const UncertainPose& odometry, const UncertainPose& match) {
  const Eigen::Vector3d error = geometry::difference(match.T_a_b, odometry.T_a_b);
  const auto position = [](const Eigen::Matrix3d& c) { return c(0, 0) + c(1, 1); };
  translation_.add(error.x() * error.x() + error.y() * error.y(), position(odometry.covariance),
                   position(match.covariance));
  heading_.add(error.z() * error.z(), odometry.covariance(2, 2), match.covariance(2, 2));
}

double OdometryMonitor::Ratio::expected_factor() const {
  return std::clamp(kMargin * weighted_ / weight_, kLeastExpected, kLargestFactor);
}

Eigen::Matrix3d OdometryMonitor::widened(const Eigen::Matrix3d& configured) const {
  return scaled(configured, translation_.factor(), heading_.factor());
}

Eigen::Matrix3d OdometryMonitor::expected(const Eigen::Matrix3d& configured) const {
  return scaled(configured, translation_.expected_factor(), heading_.expected_factor());
}

}  // namespace topogeo::localization
