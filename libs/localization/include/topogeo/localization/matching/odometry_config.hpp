// How noisy the odometry of a robot is.
#pragma once

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

}  // namespace topogeo::localization
