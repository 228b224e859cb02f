// Settings of the collision guard.
#pragma once

#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/reaction_times.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::navigation {

struct GuardConfig {
  geometry::Footprint footprint;  ///< of a body that is not round; without corners: it is round
  double radius_m = 0.267;        ///< of a round body
  double minimum_turning_radius_m = 0.0;  ///< of the base; 0: it turns on the spot
  double margin_m = 0.05;
  double side_margin_m = 0.02;
  double deceleration_m_per_s2 = 0.5;
  double delay_s = geometry::kCommandDelay_s;
  double runs_on_s = geometry::kBaseWatchdog_s;
  double oldest_scan_s = 0.6;
  bool needs_scan = true;
  bool needs_sonar = false;
  double sonar_reach_m = 1.5;
  double sonar_least_m = 0.16;
  double silent_s = 1.0;
  bool laser_fields = true;
  double warning_field_m_per_s = 0.2;
};

/// Whether paths must fit the outline in every pose: the body is not round, or the base cannot turn
/// on the spot.
bool plans_poses(const GuardConfig& config);

/// The outline of the body; of a round one, a polygon around it.
geometry::Footprint outline_of(const GuardConfig& config);

/// Declares the section `guard`, `robot.footprint` and `base.minimum_turning_radius_m`.
void describe(GuardConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range, or the fault of the footprint.
void check(const GuardConfig& config);

}  // namespace topogeo::navigation
