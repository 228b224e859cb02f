// Uncertainty of odometry and the resulting search space (Thesis, 6.2.1; docs/algorithms.md,
// "Odometry model and search space").
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_config.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// A relative pose with its covariance of (x, y, theta) in the frame of its first index; m and rad.
struct UncertainPose {
  geometry::Pose2 T_a_b;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// T_a_c and its covariance, for independent errors.
UncertainPose compose(const UncertainPose& T_a_b, const UncertainPose& T_b_c);
/// T_b_a.
UncertainPose inverse(const UncertainPose& T_a_b);

/// Whether both standard deviations are within 0.3 m and 0.1 rad.
bool well_known(const Eigen::Matrix3d& covariance);

/// Adds one step of odometry to a relative pose (Thesis, eq. 6.4, 6.6, 6.7).
UncertainPose advance(const UncertainPose& from, const geometry::Pose2& T_before_after,
                      const OdometryNoise& noise);

/// Odometry from the previous stop to the stop of `map`, through all scans in between.
/// `T_odom_previous` is the odometry at the previous stop.
UncertainPose odometry_between_stops(const geometry::Pose2& T_odom_previous,
                                     const topomap::LocalMap& map, const OdometryNoise& noise);

/// The covariance plus a centimetre and a fifth of a degree: a standing robot has no odometry
/// error, but weighing and searching invert the covariance.
Eigen::Matrix3d invertible(Eigen::Matrix3d covariance);

/// Half-widths (m, m, rad) of the rectangle around the error ellipse of the given probability
/// (eq. 6.22; ErrorEllipse) and of `heading_sigmas` standard deviations of heading (eq. 6.23).
/// 0 < probability < 1.
Eigen::Vector3d search_half_width(const Eigen::Matrix3d& covariance, double probability,
                                  double heading_sigmas);

// The ellipse in which a position lies with a given probability, and the rectangle around it: the
// space that a search has to cover (Thesis, 6.2.1.2 and 6.2.1.3; docs/algorithms.md, "Odometry
// model and search space").
//
// The thesis inverts the covariance and writes the ellipse as A x^2 + 2 B x y + C y^2 = k^2 (eq.
// 6.16, with the 2 that its print lacks). Here the same axes come from the covariance itself, which
// also works if one variance is zero. Eq. 6.18 allows two directions; this is always that of the
// major axis: 1/2 atan2(-2B, C - A).

/// Centred on the mean of the position.
struct ErrorEllipse {
  double semi_major_m = 0.0;
  double semi_minor_m = 0.0;
  double direction_rad = 0.0;  ///< of the major axis from x, in (-pi/2, pi/2]; 0 for a circle
};

/// k^2 = -2 ln(1 - P) of eq. 6.22: the squared Mahalanobis radius of the ellipse that holds
/// probability P. Throws std::invalid_argument unless 0 < probability < 1.
double ellipse_k2(double probability);

/// The ellipse of squared Mahalanobis radius `k2` of a covariance of (x, y) in m^2 (eq. 6.14 to
/// 6.20). Throws std::invalid_argument if the covariance is not symmetric, finite and positive
/// semidefinite, or k2 is negative or not finite.
ErrorEllipse error_ellipse(const Eigen::Matrix2d& covariance_m2, double k2);

/// Half-widths along x and y of the rectangle around the ellipse (definition 6.2.1); each is k
/// times the standard deviation along its axis.
Eigen::Vector2d bounding_half_width_m(const ErrorEllipse& ellipse);

}  // namespace topogeo::localization
