// Dead reckoning with the errors of an RWI B21's wheels: the distance has a constant scale error,
// the heading drifts to one side and wanders with the path, and turns are measured inexactly.
#pragma once

#include <numbers>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

struct OdometryDrift {
  double range_scale_error = 0.02;         ///< measured distance = (1 + this) * true distance
  double range_sigma_m_per_sqrt_m = 0.01;  ///< random part, grows with the root of the path
  double heading_drift_rad_per_m = 0.15 * std::numbers::pi / 180.0;      ///< systematic
  double heading_sigma_rad_per_sqrt_m = 0.3 * std::numbers::pi / 180.0;  ///< random walk
  double turn_sigma_rad_per_sqrt_rad = 0.5 * std::numbers::pi / 180.0;   ///< per root of turning
  double turn_scale_error = 0.0;                 ///< measured turn = (1 + this) * true turn
  double lateral_sigma_m_per_sqrt_m = 0.0;       ///< slips sideways while driving
  double turn_shift_sigma_m_per_sqrt_rad = 0.0;  ///< in x and y: does not turn about its origin
};

class OdometryModel {
 public:
  OdometryModel(const OdometryDrift& drift, support::Random random)
      : drift_(drift), random_(random), slip_random_(random.next_u64()) {}

  /// Moves the robot to its next true pose; returns its odometry there. The first call sets the
  /// origin: it returns the identity.
  geometry::Pose2 advance(const geometry::Pose2& T_world_robot);

  /// Carries the robot away: its odometry does not notice, and keeps its pose.
  void carry(const geometry::Pose2& T_world_robot) { T_world_last_ = T_world_robot; }

 private:
  OdometryDrift drift_;
  support::Random random_;
  support::Random slip_random_;
  std::optional<geometry::Pose2> T_world_last_;
  geometry::Pose2 T_odom_robot_;
};

}  // namespace topogeo::simulation
