#include "topogeo/navigation/follower_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {

void describe(FollowerConfig& config, support::ConfigSchema& schema) {
  schema.add("navigator.speed_m_per_s", &config.speed_m_per_s, 0.01, 3.0, "m/s",
             "largest speed, on a straight path with nothing near");
  schema.add("navigator.turn_rad_per_s", &config.turn_rad_per_s, 0.01, 6.0, "rad/s",
             "largest angular velocity");
  schema.add(
      "navigator.acceleration_m_per_s2", &config.acceleration_m_per_s2, 0.01, 10.0, "m/s2",
      "largest acceleration; less than the base can reach, so that it keeps up with its commands");
  schema.add("navigator.turn_acceleration_rad_per_s2", &config.turn_acceleration_rad_per_s2, 0.01,
             20.0, "rad/s2", "largest angular acceleration; less than the base can reach");
  schema.add("navigator.delay_s", &config.delay_s, 0.0, 1.0, "s",
             "time from a command until the base obeys it; commands are computed for the robot's "
             "pose at that time");
  schema.add("navigator.arrival_m", &config.arrival_m, 0.005, 1.0, "m",
             "the robot has arrived within this distance of the goal");
  schema.add("navigator.arrival_rad", &config.arrival_rad, 0.002, 1.0, "rad",
             "the robot has arrived within this angle of the goal's heading, if the goal has one");
}

void check(const FollowerConfig& config) {
  support::check_ranges(config);
  support::require_between("begin_turn_rad", config.begin_turn_rad, 0.0, 1.0, "rad");
  support::require_between("minimum_radius_m", config.minimum_radius_m, 0.0, 10.0, "m");
}

}  // namespace topogeo::navigation
