#include "config_navigator.hpp"

namespace topogeo::pipeline {
namespace {

using support::ConfigSchema;

void describe_motion(navigation::NavigatorConfig& n, ConfigSchema& schema) {
  schema.add("navigator.motion", &n.motion,
             {{"smooth", navigation::MotionStyle::kSmooth},
              {"primitives", navigation::MotionStyle::kPrimitives}},
             "smooth: arcs round the corners; primitives: advance, turn left, turn right");
  schema.add("navigator.speed_m_per_s", &n.speed_m_per_s, 0.01, 3.0, "m/s",
             "at most, on a straight way with nothing near");
  schema.add("navigator.turn_rad_per_s", &n.turn_rad_per_s, 0.01, 6.0, "rad/s",
             "of turns, at most");
  schema.add("navigator.acceleration_m_per_s2", &n.acceleration_m_per_s2, 0.01, 10.0, "m/s2",
             "less than what the base can do, so that it keeps up with its commands");
  schema.add("navigator.turn_acceleration_rad_per_s2", &n.turn_acceleration_rad_per_s2, 0.01, 20.0,
             "rad/s2", "the same for turns");
  schema.add("navigator.delay_s", &n.delay_s, 0.0, 1.0, "s",
             "from a command until the base obeys it; commands are for where the robot is then");
  schema.add("navigator.arrival_m", &n.arrival_m, 0.005, 1.0, "m",
             "so near to the goal the robot has arrived");
  schema.add("navigator.arrival_rad", &n.arrival_rad, 0.002, 1.0, "rad",
             "and so near to the heading, where one is wanted");
  schema.add("navigator.settle_s", &n.settle_s, 0.0, 10.0, "s",
             "stands so long at the goal and looks where it really is");
  schema.add("navigator.look_around_m", &n.look_around_m, 0.0, 50.0, "m",
             "how far it may go without a pose, where the goal allows it to look around");
  schema.add("navigator.min_radius_m", &n.smooth.min_radius_m, 0.01, 10.0, "m",
             "tightest arc; corners with less room are turned on the spot");
  schema.add("navigator.max_radius_m", &n.smooth.max_radius_m, 0.01, 100.0, "m",
             "arcs are as wide as fits, up to this");
  schema.add("navigator.path_step_m", &n.smooth.step_m, 0.005, 10.0, "m",
             "between samples of the path");
}

void describe_patience(navigation::NavigatorConfig& n, ConfigSchema& schema) {
  schema.add("navigator.oldest_pose_s", &n.oldest_pose_s, 0.1, 60.0, "s",
             "an older pose is none, and the robot stops");
  schema.add("navigator.oldest_odometry_s", &n.oldest_odometry_s, 0.1, 10.0, "s",
             "the same for odometry; a base reports ten times a second");
  schema.add("navigator.largest_sigma_m", &n.largest_sigma_m, 0.05, 5.0, "m",
             "a pose that is less certain than this is lost, and the robot stops");
  schema.add("navigator.obstacle_wait_s", &n.obstacle_wait_s, 0.0, 600.0, "s",
             "for what may move away, before another route is asked for");
  schema.add("navigator.blockage_s", &n.blockage_s, 1.0, 86400.0, "s",
             "so long a blockage is believed without being seen again");
  schema.add("navigator.route_wait_s", &n.route_wait_s, 0.1, 600.0, "s",
             "for the planner to answer");
  schema.add("navigator.stuck_s", &n.stuck_s, 0.2, 60.0, "s",
             "told to move and not moving for so long: something holds the robot");
  schema.add("navigator.detour_half_side_m", &n.detour.half_side_m, 0.5, 20.0, "m",
             "half of the side of the window in which a way round an obstacle is looked for");
  schema.add("navigator.detour_snap_m", &n.detour.start_snap_m, 0.0, 5.0, "m",
             "a detour may begin so far from the robot, where it stands near an obstacle");
}

void describe_guard(navigation::GuardConfig& g, ConfigSchema& schema) {
  schema.add("guard.radius_m", &g.radius_m, 0.05, 2.0, "m", "of the robot's round body");
  schema.add("guard.margin_m", &g.margin_m, 0.0, 1.0, "m",
             "nothing comes nearer to the body while it drives");
  schema.add("guard.side_margin_m", &g.side_margin_m, 0.0, 1.0, "m",
             "it passes what is beside it at this distance: in doors there is no more");
  schema.add("guard.deceleration_m_per_s2", &g.deceleration_m_per_s2, 0.05, 10.0, "m/s2",
             "that the base surely can: its speed is such that it can stop before what it sees");
  schema.add("guard.delay_s", &g.delay_s, 0.0, 2.0, "s",
             "from a measurement until the base obeys what follows from it");
  schema.add("guard.oldest_scan_s", &g.oldest_scan_s, 0.05, 10.0, "s",
             "an older scan is none; a laser gives two to ten a second");
  schema.add("guard.needs_scan", &g.needs_scan,
             "no motion without a laser scan; off: sonars are enough");
  schema.add("guard.needs_sonar", &g.needs_sonar, "no motion without sonars");
  schema.add("guard.sonar_reach_m", &g.sonar_reach_m, 0.2, 5.0, "m",
             "sonars must hear what the laser sees in their cone nearer than this");
  schema.add(
      "guard.sonar_least_m", &g.sonar_least_m, 0.0, 1.0, "m",
      "a sonar that reads this or less may have something at the body: they measure no less");
  schema.add("guard.silent_s", &g.silent_s, 0.1, 60.0, "s",
             "so long without an echo where there must be one, and the sonars count as silent");
}

void describe_markov(navigation::NavigatorConfig& n, ConfigSchema& schema) {
  schema.add("navigator.pose_source", &n.pose_source,
             {{"localizer", navigation::PoseSource::kLocalizer},
              {"markov", navigation::PoseSource::kMarkov}},
             "markov: on the grid from the first pose on, looking at each border node; without a "
             "laser's localizer, on floors with walls that sonars hear");
  markov::MarkovConfig& m = n.markov.markov;
  schema.add("markov.by_laser", &n.markov_by_laser,
             "range readings of the laser instead of those of the sonars");
  schema.add("markov.window_cells", &m.window_cells, 5, 101, "cells",
             "side of the window of probabilities, odd; the source: 21");
  schema.add("markov.perceptual_weight", &m.perceptual_weight, 0.0, 1.0, "-",
             "of readings that are wholly reliable, against the movement; the source: 0.6");
  schema.add("markov.cell_m", &n.markov.cell_m, 0.01, 1.0, "m", "side of a cell; the source: 0.1");
  schema.add("markov.heading_sigma_rad", &n.markov.heading_sigma_rad, 0.001, 1.0, "rad",
             "of the heading, which is that of odometry");
  schema.add("markov.scale_m", &m.sonar.scale_m, 0.001, 10.0, "m",
             "a mean difference of the readings by this much makes a place e times less likely");
  schema.add("markov.difference_cap_m", &m.sonar.difference_cap_m, 0.01, 20.0, "m",
             "a larger difference counts as this: one reading of a person must not decide");
}

}  // namespace

void describe_navigator(navigation::NavigatorConfig& config, ConfigSchema& schema) {
  describe_motion(config, schema);
  describe_patience(config, schema);
  describe_markov(config, schema);
  describe_guard(config.guard, schema);
}

}  // namespace topogeo::pipeline
