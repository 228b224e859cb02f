// Noise of the odometry of a robot.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

/// Variances that grow with the distance travelled, as in the Thesis, 6.2, eq. 6.8
/// (docs/algorithms.md, "Odometry model and search space"), so that they do not depend on the
/// division of a path into steps. In the frame of the step the thesis's diag(|dx|, |dy|, |dtheta|)
/// K_error is translation_m2_per_m = K_error(1,1), heading_rad2_per_rad = K_error(3,3) and zero for
/// the rest, because its robot never moves sideways. The other fields are not in the thesis:
/// - heading_rad2_per_m: wheels slip and differ on a straight path too. Without it every corridor
///   makes the covariance optimistic, which was the costliest mistake of all trials.
/// - lateral_m2_per_m: carpets push the robot sideways, which its wheels do not measure.
/// - translation_m2_per_rad: a turn moves a robot that does not turn exactly about the reference
///   point of its odometry; also an unknown offset of the laser.
/// The defaults are several times the random errors of poor wheels, because errors of real wheels
/// are systematic: 3 % of the distance, the same in every step, adds up as no random error does.
/// `topogeo calibrate-odometry` estimates the values of a robot from a log
/// (odometry_calibration.hpp).
struct OdometryNoise {
  double translation_m2_per_m = 0.02;
  double translation_m2_per_rad = 0.016;
  double lateral_m2_per_m = 0.004;
  double heading_rad2_per_m = 0.16;
  double heading_rad2_per_rad = 0.2;
};

// Range of each; translation_m2_per_rad may also be 0. No wheel has less noise than the smallest
// value, which would make covariances singular.
inline constexpr double kSmallestOdometryNoise = 1e-6;
inline constexpr double kLargestOdometryNoise = 1.0;

/// Declares the section `odometry`.
void describe(OdometryNoise& noise, support::ConfigSchema& schema);

}  // namespace topogeo::localization
