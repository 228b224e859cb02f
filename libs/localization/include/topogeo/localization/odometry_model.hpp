// Uncertainty of odometry and the search space that follows from it (spec A3, thesis 6.2.1).
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// Variances that grow with the way travelled, as in 6.8, so that they do not depend on how the way
/// is cut into steps. In the frame of the step the source's diag(|dx|, |dy|, |dtheta|) K_error is
/// translation_m2_per_m = K_error(1,1), heading_rad2_per_rad = K_error(3,3) and zero for the rest,
/// as its robot never moves sideways. What the source does not have, and why it is here:
/// - heading_rad2_per_m: wheels slip and differ on a straight way too. Without it every corridor
///   makes the covariance optimistic, which was the costliest mistake of all trials.
/// - lateral_m2_per_m: carpets push the robot sideways, which its wheels do not measure.
/// - translation_m2_per_rad: a turn moves a robot that does not turn exactly about the point that
///   its odometry speaks of.
/// The defaults are several times what poor wheels do at random, because the errors of real ones
/// are systematic: 3 % of the way, the same in every step, add up as no random error does. `topogeo
/// calibrate-odometry` finds the values of a robot from a log (odometry_calibration.hpp).
struct OdometryNoise {
  double translation_m2_per_m = 0.02;     ///< along the motion
  double translation_m2_per_rad = 0.016;  ///< in x and y, per turn: also an unknown laser offset
  double lateral_m2_per_m = 0.004;        ///< across the motion
  double heading_rad2_per_m = 0.16;
  double heading_rad2_per_rad = 0.2;
};

/// A relative pose with its covariance of (x, y, theta) in the frame of its first index; m and rad.
struct UncertainPose {
  geometry::Pose2 T_a_b;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// T_a_c and its covariance, of two that know nothing of each other's errors.
UncertainPose compose(const UncertainPose& T_a_b, const UncertainPose& T_b_c);
/// T_b_a.
UncertainPose inverse(const UncertainPose& T_a_b);

/// Adds one step of odometry to a relative pose (6.4, 6.6, 6.7).
UncertainPose advance(const UncertainPose& from, const geometry::Pose2& T_before_after,
                      const OdometryNoise& noise);

/// Odometry from the previous stop to the stop of `map`, through all scans between.
/// `T_odom_previous` is the odometry at the previous stop.
UncertainPose odometry_between_stops(const geometry::Pose2& T_odom_previous,
                                     const topomap::LocalMap& map, const OdometryNoise& noise);

/// The covariance with a centimetre and a fifth of a degree more: a standing robot has no odometry
/// error, but what weighs or searches by a covariance has to invert it.
Eigen::Matrix3d invertible(Eigen::Matrix3d covariance);

/// Half-widths (m, m, rad) of the rectangle around the error ellipse of the given probability
/// (6.22; error_ellipse.hpp) and of `heading_sigmas` standard deviations of heading (6.23).
/// 0 < probability < 1.
Eigen::Vector3d search_half_width(const Eigen::Matrix3d& covariance, double probability,
                                  double heading_sigmas);

}  // namespace topogeo::localization
