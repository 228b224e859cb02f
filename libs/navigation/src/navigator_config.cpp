#include "topogeo/navigation/navigator_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {
namespace {

void describe_motion(NavigatorConfig& n, support::ConfigSchema& schema) {
  schema.add("navigator.motion", &n.motion,
             {{"smooth", MotionStyle::kSmooth}, {"primitives", MotionStyle::kPrimitives}},
             "smooth: arcs around the corners; primitives: advance, turn left, turn right");
  describe(n.follower, schema);
  schema.add("navigator.settle_s", &n.settle_s, 0.0, 10.0, "s",
             "rest at the goal, to measure where the robot really is");
  schema.add("navigator.look_around_m", &n.look_around_m, 0.0, 50.0, "m",
             "how far it may go without a pose, where the goal allows it to look around");
}

void describe_patience(NavigatorConfig& n, support::ConfigSchema& schema) {
  schema.add("navigator.oldest_pose_s", &n.oldest_pose_s, 0.1, 60.0, "s",
             "an older pose is none, and the robot stops");
  schema.add("navigator.oldest_odometry_s", &n.oldest_odometry_s, 0.1, 10.0, "s",
             "the same for odometry; a base reports ten times a second");
  schema.add("navigator.largest_sigma_m", &n.largest_sigma_m, 0.05, 5.0, "m",
             "a pose that is less certain than this is lost, and the robot stops");
  schema.add("navigator.obstacle_wait_s", &n.obstacle_wait_s, 0.0, 600.0, "s",
             "for what may move away, before another route is requested");
  schema.add("navigator.blockage_s", &n.blockage_s, 1.0, 86400.0, "s",
             "so long a blockage counts without being seen again");
  schema.add("navigator.route_wait_s", &n.route_wait_s, 0.1, 600.0, "s",
             "for the planner to answer");
  schema.add("navigator.stuck_s", &n.stuck_s, 0.2, 60.0, "s",
             "commanded to move and not moving for so long: something holds the robot");
}

}  // namespace

void describe(MarkovTrackerConfig& config, support::ConfigSchema& schema) {
  schema.add(
      "markov.grid", &config.grid,
      {{"poses", MarkovGrid::kPoses}, {"positions", MarkovGrid::kPositions}},
      "poses: positions and headings, sonars are heard while it drives; positions: MACONDO's "
      "window, sonars are heard where it stops at border nodes");
  schema.add("markov.cell_m", &config.cell_m, 0.01, 1.0, "m",
             "side of a cell; cells of the map are joined up to it; MACONDO: 0.1");
  schema.add("markov.heading_sigma_rad", &config.heading_sigma_rad, 0.001, 1.0, "rad",
             "of the heading, which is that of odometry");
  schema.add(
      "markov.station", &config.station,
      "base station of the map that the robot starts at; another name does where the map has "
      "one base station alone, and where it has none the first pose of a localizer");
  schema.add("markov.station_heading_rad", &config.station_heading_rad, -3.1416, 3.1416, "rad",
             "its heading at a place of that name that has none in the map, map frame");
}

void check(const MarkovTrackerConfig& config) {
  support::check_ranges(config);
  markov::check(config.markov);
  markov::check(config.poses);
}

void describe(NavigatorConfig& config, support::ConfigSchema& schema) {
  describe_motion(config, schema);
  describe_patience(config, schema);
  schema.add("navigator.pose_source", &config.pose_source,
             {{"localizer", PoseSource::kLocalizer}, {"markov", PoseSource::kMarkov}},
             "markov: on the grid from the first pose on, measuring at each border node; without a "
             "laser's localizer, on floors with walls that sonars hear");
  schema.add("markov.by_laser", &config.markov_by_laser,
             "range readings of the laser instead of those of the sonars");
  describe(config.markov, schema);
  describe(config.guard, schema);
}

void check(const NavigatorConfig& config) {
  support::check_ranges(config);
  markov::check(config.markov.markov);
  markov::check(config.markov.poses);
  planning::check(config.detour);
  planning::check(config.smooth);
}

}  // namespace topogeo::navigation
