#include "topogeo/navigation/follower_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {

void describe(FollowerConfig& config, support::ConfigSchema& schema) {
  schema.add("navigator.speed_m_per_s", &config.speed_m_per_s, 0.01, 3.0, "m/s",
             "at most, on a straight path with nothing near");
  schema.add("navigator.turn_rad_per_s", &config.turn_rad_per_s, 0.01, 6.0, "rad/s",
             "of turns, at most");
  schema.add("navigator.acceleration_m_per_s2", &config.acceleration_m_per_s2, 0.01, 10.0, "m/s2",
             "less than what the base can do, so that it keeps up with its commands");
  schema.add("navigator.turn_acceleration_rad_per_s2", &config.turn_acceleration_rad_per_s2, 0.01,
             20.0, "rad/s2", "the same for turns");
  schema.add("navigator.delay_s", &config.delay_s, 0.0, 1.0, "s",
             "from a command until the base obeys it; commands are for where the robot is then");
  schema.add("navigator.arrival_m", &config.arrival_m, 0.005, 1.0, "m",
             "so near to the goal the robot has arrived");
  schema.add("navigator.arrival_rad", &config.arrival_rad, 0.002, 1.0, "rad",
             "and so near to the heading, where one is wanted");
}

void check(const FollowerConfig& config) {
  support::check_ranges(config);
  support::require_between("begin_turn_rad", config.begin_turn_rad, 0.0, 1.0, "rad");
}

}  // namespace topogeo::navigation
