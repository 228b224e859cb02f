#include "topogeo/pipeline/local_mapper_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

void describe(LocalMapperConfig& config, support::ConfigSchema& schema) {
  constexpr std::uint32_t kLongestOnTheWire = 256;  // bound of the sequence in the interface file
  schema.add(
      "laser.x_m", &config.T_robot_laser.x_m, -5.0, 5.0, "m",
      "mounting of the laser on the robot, forward of the point that odometry refers to; where no "
      "key of this section is set, what a log states");
  schema.add("laser.y_m", &config.T_robot_laser.y_m, -5.0, 5.0, "m", "the same, to the left");
  schema.add("laser.yaw_rad", &config.T_robot_laser.theta_rad, -3.1416, 3.1416, "rad",
             "the same, counter-clockwise; 0: the laser looks forward");
  schema.add("stop.distance_m", &config.stop_distance_m, 0.1, 10.0, "m",
             "travelled distance after which a stop is made; shorter: more maps, more work, better "
             "in poor odometry");
  schema.add("stop.turn_rad", &config.stop_turn_rad, 0.05, 3.14, "rad",
             "turn after which a stop is made");
  schema.add(
      "stop.longest_track", &config.longest_track, 2U, kLongestOnTheWire, "scans",
      "scans between two stops whose poses are kept; of more, while the robot stands, evenly "
      "spread ones");
}

}  // namespace topogeo::pipeline
