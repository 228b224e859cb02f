// Settings of the path follower.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::navigation {

struct FollowerConfig {
  double speed_m_per_s = 0.6;
  double turn_rad_per_s = 1.0;
  double acceleration_m_per_s2 = 0.5;
  double turn_acceleration_rad_per_s2 = 2.0;
  double delay_s = 0.15;
  double arrival_m = 0.03;    ///< accuracy of stops
  double arrival_rad = 0.02;  ///< accuracy of turns on the spot
  /// Heading errors up to this are corrected while driving, [0, 1]. Not in the configuration file,
  /// because the style of motion decides it.
  double begin_turn_rad = 0.4;
  /// Smallest turning radius of the base, metres; 0: it turns on the spot. Not in this section of
  /// the configuration file.
  double minimum_radius_m = 0.0;
};

/// Declares the speeds of the section `navigator`.
void describe(FollowerConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const FollowerConfig& config);

}  // namespace topogeo::navigation
