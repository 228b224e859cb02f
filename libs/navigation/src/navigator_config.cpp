#include "topogeo/navigation/navigator_config.hpp"

#include <stdexcept>

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {
namespace {

void describe_motion(NavigatorConfig& n, support::ConfigSchema& schema) {
  schema.add("navigator.motion", &n.motion,
             {{"smooth", MotionStyle::kSmooth}, {"primitives", MotionStyle::kPrimitives}},
             "smooth: arcs around the corners; primitives: advance, turn left, turn right");
  describe(n.follower, schema);
  schema.add("navigator.settle_s", &n.settle_s, 0.0, 10.0, "s",
             "rest at the goal before the robot's final pose is measured");
  schema.add(
      "navigator.look_around_m", &n.look_around_m, 0.0, 50.0, "m",
      "longest distance driven without a pose, for goals that allow the robot to look around");
}

void describe_patience(NavigatorConfig& n, support::ConfigSchema& schema) {
  schema.add("navigator.oldest_pose_s", &n.oldest_pose_s, 0.1, 60.0, "s",
             "largest age of a pose; without a newer one the robot stops");
  schema.add("navigator.oldest_odometry_s", &n.oldest_odometry_s, 0.1, 10.0, "s",
             "largest age of odometry; a base reports it ten times a second");
  schema.add("navigator.largest_sigma_m", &n.largest_sigma_m, 0.05, 5.0, "m",
             "largest standard deviation of a pose in the direction in which it is known best, and "
             "a quarter of the largest in the other, as along a bare corridor; a less certain pose "
             "counts as lost, and the robot stops");
  schema.add("navigator.obstacle_wait_s", &n.obstacle_wait_s, 0.0, 600.0, "s",
             "time in which an obstacle may move away before another route is requested");
  schema.add("navigator.blockage_s", &n.blockage_s, 1.0, 86400.0, "s",
             "time for which a blockage counts without being seen again");
  schema.add("navigator.route_wait_s", &n.route_wait_s, 0.1, 600.0, "s",
             "time in which the planner must answer");
  schema.add("navigator.stuck_s", &n.stuck_s, 0.2, 60.0, "s",
             "a robot that is commanded to move and does not for this time is stuck");
}

}  // namespace

void describe(MarkovTrackerConfig& config, support::ConfigSchema& schema) {
  schema.add("markov.grid", &config.grid,
             {{"poses", MarkovGrid::kPoses}, {"positions", MarkovGrid::kPositions}},
             "poses: positions and headings, updated by sonars while the robot drives; positions: "
             "MACONDO's window, updated by sonars where the robot stops at border nodes");
  schema.add("markov.cell_m", &config.cell_m, 0.01, 1.0, "m",
             "side of a cell; cells of the map are joined up to this size; MACONDO: 0.1");
  schema.add("markov.heading_sigma_rad", &config.heading_sigma_rad, 0.001, 1.0, "rad",
             "standard deviation of the heading, which odometry provides");
  schema.add("markov.station", &config.station,
             "base station of the map where the robot starts; if the map has no such name, its "
             "only base station; if it has none, the first pose of a localizer");
  schema.add("markov.station_heading_rad", &config.station_heading_rad, -3.1416, 3.1416, "rad",
             "heading of the robot on its base station in the map frame, if the map has no heading "
             "for it");
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
             "localizer: poses of the localizer; markov: Markov localization on the grid from the "
             "first pose on, for robots without a laser on floors with walls that sonars detect");
  schema.add("markov.by_laser", &config.markov_by_laser,
             "uses range readings of the laser instead of those of the sonars");
  describe(config.markov, schema);
  describe(config.guard, schema);
}

void check(const NavigatorConfig& config) {
  support::check_ranges(config);
  check(config.guard);
  if (config.motion == MotionStyle::kPrimitives && config.guard.minimum_turning_radius_m > 0.0) {
    throw std::invalid_argument(
        "key 'navigator.motion' = 'primitives': expected 'smooth' with "
        "base.minimum_turning_radius_m, because primitives turn on the spot");
  }
  markov::check(config.markov.markov);
  markov::check(config.markov.poses);
  planning::check(config.detour);
  planning::check(config.smooth);
}

}  // namespace topogeo::navigation
