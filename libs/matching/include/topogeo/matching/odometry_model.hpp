// Uncertainty of odometry and the resulting search space (Thesis, 6.2.1; docs/algorithms.md,
// "Odometry model and search space").
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_config.hpp"
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
/// (eq. 6.22; error_ellipse.hpp) and of `heading_sigmas` standard deviations of heading (eq. 6.23).
/// 0 < probability < 1.
Eigen::Vector3d search_half_width(const Eigen::Matrix3d& covariance, double probability,
                                  double heading_sigmas);

}  // namespace topogeo::localization
