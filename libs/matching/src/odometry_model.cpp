#include "topogeo/matching/odometry_model.hpp"

#include <cmath>

namespace topogeo::localization {

using geometry::Pose2;

UncertainPose compose(const UncertainPose& a, const UncertainPose& b) {
  return {a.T_a_b * b.T_a_b,
          geometry::compose_covariance(a.T_a_b, a.covariance, b.T_a_b, b.covariance)};
}

UncertainPose inverse(const UncertainPose& a) {
  return {geometry::inverse(a.T_a_b), geometry::inverse_covariance(a.T_a_b, a.covariance)};
}

bool well_known(const Eigen::Matrix3d& covariance) {
  constexpr double kKnown2_m2 = 0.3 * 0.3;
  constexpr double kKnown2_rad2 = 0.1 * 0.1;
  return covariance(0, 0) + covariance(1, 1) <= kKnown2_m2 && covariance(2, 2) <= kKnown2_rad2;
}

UncertainPose advance(const UncertainPose& from, const Pose2& T_before_after,
                      const OdometryNoise& noise) {
  const double distance_m =
      std::sqrt(T_before_after.x_m * T_before_after.x_m + T_before_after.y_m * T_before_after.y_m);
  const double turn_rad = std::fabs(T_before_after.theta_rad);
  const double turn_m2 = noise.translation_m2_per_rad * turn_rad;
  Eigen::Matrix3d step = Eigen::Matrix3d::Zero();
  step(0, 0) = noise.translation_m2_per_m * distance_m + turn_m2;
  step(1, 1) = noise.lateral_m2_per_m * distance_m + turn_m2;
  // The heading wanders along the path, not only at its end: integrated over a straight step.
  const double wander_rad2 = noise.heading_rad2_per_m * distance_m;
  step(1, 1) += wander_rad2 * distance_m * distance_m / 3.0;
  step(1, 2) = step(2, 1) = wander_rad2 * distance_m / 2.0;
  step(2, 2) = wander_rad2 + noise.heading_rad2_per_rad * turn_rad;
  return {from.T_a_b * T_before_after,
          geometry::compose_covariance(from.T_a_b, from.covariance, T_before_after, step)};
}

UncertainPose odometry_between_stops(const Pose2& T_odom_previous, const topomap::LocalMap& map,
                                     const OdometryNoise& noise) {
  UncertainPose sum;
  Pose2 T_odom_before = T_odom_previous;
  for (const topomap::TrackedScan& scan : map.track) {
    sum = advance(sum, geometry::between(T_odom_before, scan.T_odom_robot), noise);
    T_odom_before = scan.T_odom_robot;
  }
  return advance(sum, geometry::between(T_odom_before, map.T_odom_robot), noise);
}

Eigen::Matrix3d invertible(Eigen::Matrix3d covariance) {
  covariance(0, 0) += 1e-4;
  covariance(1, 1) += 1e-4;
  covariance(2, 2) += 1e-5;
  return covariance;
}

Eigen::Vector3d search_half_width(const Eigen::Matrix3d& covariance, double probability,
                                  double heading_sigmas) {
  const double k = std::sqrt(ellipse_k2(probability));
  return {k * std::sqrt(covariance(0, 0)), k * std::sqrt(covariance(1, 1)),
          heading_sigmas * std::sqrt(covariance(2, 2))};
}

}  // namespace topogeo::localization
