#include "topogeo/pipeline/local_mapper_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

void describe(LocalMapperConfig& config, support::ConfigSchema& schema) {
  constexpr std::uint32_t kLongestOnTheWire = 256;  // bound of the sequence in the interface file
  schema.add("laser.x_m", &config.T_robot_laser.x_m, -5.0, 5.0, "m",
             "position of the laser ahead of the reference point of the odometry; if no key of "
             "this section is set, the mounting that the log states applies");
  schema.add("laser.y_m", &config.T_robot_laser.y_m, -5.0, 5.0, "m",
             "position of the laser to the left of that point");
  schema.add("laser.yaw_rad", &config.T_robot_laser.theta_rad, -3.1416, 3.1416, "rad",
             "heading of the laser on the robot, counter-clockwise; 0: the laser faces forward");
  schema.add("stop.distance_m", &config.stop_distance_m, 0.1, 10.0, "m",
             "travelled distance until the next stop; shorter: more maps and more work, but better "
             "results with poor odometry");
  schema.add("stop.turn_rad", &config.stop_turn_rad, 0.05, 3.14, "rad", "turn until the next stop");
  schema.add("stop.longest_track", &config.longest_track, 2U, kLongestOnTheWire, "scans",
             "most scan poses kept between two stops; a robot that stands still records more, "
             "which are thinned out evenly");
}

}  // namespace topogeo::pipeline
