#include "topogeo/geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::geometry {

double wrap_angle(double angle_rad) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  if (angle_rad > -std::numbers::pi && angle_rad <= std::numbers::pi) return angle_rad;
  const double wrapped = angle_rad - kTurn * std::nearbyint(angle_rad / kTurn);
  // After many turns the rounding of the product can exceed either border by its last place.
  return wrapped <= -std::numbers::pi ? std::min(wrapped + kTurn, std::numbers::pi)
                                      : std::min(wrapped, std::numbers::pi);
}

Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c) {
  const SinCos r = sincos(T_a_b.theta_rad);
  return {T_a_b.x_m + r.cos * T_b_c.x_m - r.sin * T_b_c.y_m,
          T_a_b.y_m + r.sin * T_b_c.x_m + r.cos * T_b_c.y_m,
          wrap_angle(T_a_b.theta_rad + T_b_c.theta_rad)};
}

Eigen::Vector2d operator*(const Pose2& T_a_b, const Eigen::Vector2d& point_b_m) {
  const SinCos r = sincos(T_a_b.theta_rad);
  return {T_a_b.x_m + r.cos * point_b_m.x() - r.sin * point_b_m.y(),
          T_a_b.y_m + r.sin * point_b_m.x() + r.cos * point_b_m.y()};
}

Pose2 inverse(const Pose2& T_a_b) {
  const SinCos r = sincos(T_a_b.theta_rad);
  return {-(r.cos * T_a_b.x_m + r.sin * T_a_b.y_m), r.sin * T_a_b.x_m - r.cos * T_a_b.y_m,
          wrap_angle(-T_a_b.theta_rad)};
}

Pose2 between(const Pose2& T_a_b, const Pose2& T_a_c) {
  return inverse(T_a_b) * T_a_c;
}

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrap_angle(a.theta_rad - b.theta_rad)};
}

Eigen::Matrix3d compose_covariance(const Pose2& T_a_b, const Eigen::Matrix3d& cov_a_b,
                                   const Pose2& T_b_c, const Eigen::Matrix3d& cov_b_c) {
  const SinCos r = sincos(T_a_b.theta_rad);
  Eigen::Matrix3d first = Eigen::Matrix3d::Identity();
  first(0, 2) = -r.sin * T_b_c.x_m - r.cos * T_b_c.y_m;
  first(1, 2) = r.cos * T_b_c.x_m - r.sin * T_b_c.y_m;
  Eigen::Matrix3d second = Eigen::Matrix3d::Identity();
  second(0, 0) = r.cos;
  second(0, 1) = -r.sin;
  second(1, 0) = r.sin;
  second(1, 1) = r.cos;
  return first * cov_a_b * first.transpose() + second * cov_b_c * second.transpose();
}

Eigen::Matrix3d inverse_covariance(const Pose2& T_a_b, const Eigen::Matrix3d& cov_a_b) {
  const SinCos r = sincos(T_a_b.theta_rad);
  const Pose2 T_b_a = inverse(T_a_b);
  Eigen::Matrix3d jacobian;
  jacobian << -r.cos, -r.sin, T_b_a.y_m, r.sin, -r.cos, -T_b_a.x_m, 0.0, 0.0, -1.0;
  return jacobian * cov_a_b * jacobian.transpose();
}

double squared_mahalanobis(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance) {
  return difference.dot(covariance.inverse() * difference);
}

}  // namespace topogeo::geometry
