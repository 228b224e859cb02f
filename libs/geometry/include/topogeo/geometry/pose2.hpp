// Poses in the plane, SE(2).
//
// A pose named T_a_b takes coordinates of frame b into frame a: p_a = T_a_b * p_b, and
// T_a_c = T_a_b * T_b_c. x forward, y left, theta counter-clockwise; metres and radians.
// These are the proper compositions for Thesis, eq. 7.6-7.9 and 7.22-7.24: local to global is
// R(theta), global to local R(-theta) (docs/algorithms.md, "Forward correction", errata).
#pragma once

#include <Eigen/Core>

namespace topogeo::geometry {

struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;  ///< in (-pi, pi] in results of the functions below

  friend bool operator==(const Pose2&, const Pose2&) = default;

  [[nodiscard]] Eigen::Vector2d position_m() const { return {x_m, y_m}; }
};

/// The same angle in (-pi, pi], for |angle_rad| <= 1e5.
double wrap_angle(double angle_rad);

/// T_a_c from T_a_b and T_b_c.
Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c);

/// Point of frame b in frame a.
Eigen::Vector2d operator*(const Pose2& T_a_b, const Eigen::Vector2d& point_b_m);

/// T_b_a from T_a_b.
Pose2 inverse(const Pose2& T_a_b);

/// T_b_c from T_a_b and T_a_c: the pose of c seen from b.
Pose2 between(const Pose2& T_a_b, const Pose2& T_a_c);

/// (x, y, theta) of `a` minus that of `b`, both in one frame, the angle wrapped; metres and
/// radians. Covariances in this project refer to this error.
Eigen::Vector3d difference(const Pose2& a, const Pose2& b);

/// Covariance of T_a_c = T_a_b * T_b_c to first order. Each covariance is of (x, y, theta) in the
/// frame of its own first index (cov_a_b in a, cov_b_c in b); the two errors are assumed
/// independent.
Eigen::Matrix3d compose_covariance(const Pose2& T_a_b, const Eigen::Matrix3d& cov_a_b,
                                   const Pose2& T_b_c, const Eigen::Matrix3d& cov_b_c);

/// Covariance of T_b_a, in b, from that of T_a_b, in a, to first order.
Eigen::Matrix3d inverse_covariance(const Pose2& T_a_b, const Eigen::Matrix3d& cov_a_b);

/// Squared Mahalanobis distance of a difference() from zero. The covariance must be invertible.
double squared_mahalanobis(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance);

/// Limit that squared_mahalanobis() exceeds in 1 % of cases if the covariance is right (chi-square,
/// three degrees of freedom).
inline constexpr double kMahalanobis2Of99Percent = 11.3;

}  // namespace topogeo::geometry
