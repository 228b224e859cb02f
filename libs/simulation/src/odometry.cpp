#include "topogeo/simulation/odometry.hpp"

#include <cmath>

namespace topogeo::simulation {

geometry::Pose2 OdometryModel::advance(const geometry::Pose2& T_world_robot) {
  if (T_world_last_) {
    const geometry::Pose2 step = geometry::between(*T_world_last_, T_world_robot);
    const double distance_m = step.position_m().norm();
    const double turn_rad = std::fabs(step.theta_rad);
    const double root_m = std::sqrt(distance_m);
    // Draws all numbers at every step, so that a change of one parameter does not affect the errors
    // of the others.
    const double range_error_m = drift_.range_sigma_m_per_sqrt_m * root_m * random_.normal();
    const double walk_rad = drift_.heading_sigma_rad_per_sqrt_m * root_m * random_.normal();
    const double turn_error_rad =
        drift_.turn_sigma_rad_per_sqrt_rad * std::sqrt(turn_rad) * random_.normal();
    const double scale =
        distance_m > 0.0 ? 1.0 + drift_.range_scale_error + range_error_m / distance_m : 1.0;
    const double heading_error_rad = drift_.heading_drift_rad_per_m * distance_m + walk_rad +
                                     turn_error_rad + drift_.turn_scale_error * step.theta_rad;
    const double shift_m = drift_.turn_shift_sigma_m_per_sqrt_rad * std::sqrt(turn_rad);
    const double shift_x_m = shift_m * slip_random_.normal();
    const double shift_y_m = shift_m * slip_random_.normal() +
                             drift_.lateral_sigma_m_per_sqrt_m * root_m * slip_random_.normal();
    T_odom_robot_ =
        T_odom_robot_ * geometry::Pose2{scale * step.x_m + shift_x_m, scale * step.y_m + shift_y_m,
                                        geometry::wrap_angle(step.theta_rad + heading_error_rad)};
  }
  T_world_last_ = T_world_robot;
  return T_odom_robot_;
}

}  // namespace topogeo::simulation
