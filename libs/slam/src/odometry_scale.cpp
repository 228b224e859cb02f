#include "odometry_scale.hpp"

#include <cmath>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr double kShortest_m = 0.2;     // smaller steps are mostly noise
constexpr double kMostTurn_rad = 0.2;   // wheels slip in turns
constexpr double kLeastKnown_m = 0.04;  // more uncertain matches lean towards odometry
constexpr double kLargestError = 0.25;  // share of the distance: more is a blow, not a scale
constexpr double kNoise_m = 0.06;       // of odometry after a metre; grows with the square root

}  // namespace

void OdometryScale::add(const Pose2& T_by_odometry, const UncertainPose& T_by_match) {
  const Eigen::Vector2d way = T_by_odometry.position_m();
  const double way_m = std::sqrt(way.squaredNorm());
  if (way_m < kShortest_m || std::fabs(T_by_odometry.theta_rad) > kMostTurn_rad) return;
  const Eigen::Vector2d along = way / way_m;
  const Eigen::Matrix2d covariance_m2 = T_by_match.covariance.topLeftCorner<2, 2>();
  const double variance_m2 = along.dot(covariance_m2 * along);
  if (variance_m2 > kLeastKnown_m * kLeastKnown_m) return;
  const double matched_m = along.dot(T_by_match.T_a_b.position_m());
  // Relative to the mean of both: relative to one of them, noise that makes it longer would count
  // differently from noise that makes it shorter.
  const double mean_m = 0.5 * (matched_m + way_m);
  if (std::fabs(matched_m - way_m) > kLargestError * mean_m) return;
  const double weight = 1.0 / (variance_m2 + kNoise_m * kNoise_m * mean_m);
  constexpr double kFading = 1.0 - 1.0 / static_cast<double>(kMemory);
  matched_ = kPrior + kFading * (matched_ - kPrior) + weight * matched_m;
  driven_ = kPrior + kFading * (driven_ - kPrior) + weight * way_m;
}

Pose2 scaled(const Pose2& T_by_odometry, double factor) {
  return {factor * T_by_odometry.x_m, factor * T_by_odometry.y_m, T_by_odometry.theta_rad};
}

}  // namespace topogeo::localization
