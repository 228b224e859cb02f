#include "settings.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::ros_bridge {
namespace {

using support::ConfigSchema;

std::vector<std::pair<const char*, std::string*>> names_of(Settings::Topics& topics) {
  return {{"scan", &topics.scan},
          {"odometry", &topics.odometry},
          {"tf", &topics.tf},
          {"tf_static", &topics.tf_static},
          {"map", &topics.map},
          {"map_updates", &topics.map_updates},
          {"pose", &topics.pose},
          {"plan", &topics.plan},
          {"graph", &topics.graph},
          {"rooms", &topics.rooms},
          {"velocity", &topics.velocity},
          {"initial_pose", &topics.initial_pose},
          {"goal", &topics.goal},
          {"diagnostics", &topics.diagnostics},
          {"clock", &topics.clock}};
}

const char* meaning(const std::string& topic) {
  static const std::vector<std::pair<std::string, const char*>> kMeanings = {
      {"scan", "sensor_msgs/LaserScan"},
      {"odometry", "nav_msgs/Odometry"},
      {"tf", "tf2_msgs/TFMessage: frames that move"},
      {"tf_static", "tf2_msgs/TFMessage: frames that do not, the laser's among them"},
      {"map", "nav_msgs/OccupancyGrid"},
      {"map_updates", "map_msgs/OccupancyGridUpdate; Nav2 wants the name of the map + _updates"},
      {"pose", "geometry_msgs/PoseWithCovarianceStamped"},
      {"plan", "nav_msgs/Path"},
      {"graph", "visualization_msgs/MarkerArray: nodes and branches of the map"},
      {"rooms", "visualization_msgs/MarkerArray: names of rooms and places"},
      {"velocity", "geometry_msgs/Twist or TwistStamped"},
      {"initial_pose", "geometry_msgs/PoseWithCovarianceStamped: where the robot is"},
      {"goal", "geometry_msgs/PoseStamped: where it shall go"},
      {"diagnostics", "diagnostic_msgs/DiagnosticArray: the services of topogeo"},
      {"clock", "rosgraph_msgs/Clock"}};
  return std::ranges::find(kMeanings, topic, &std::pair<std::string, const char*>::first)->second;
}

void describe_topics(ConfigSchema& schema, Settings& settings) {
  for (const auto& [key, name] : names_of(settings.topics)) {
    schema.add(std::string("topics.") + key, name, meaning(key));
  }
  Settings::Frames& frames = settings.frames;
  schema.add("frames.map", &frames.map, "REP 105: fixed, without drift");
  schema.add("frames.odom", &frames.odom, "REP 105: without jumps");
  schema.add("frames.robot", &frames.robot,
             "base_link of REP 105; empty: the child frame of the odometry, or base_link where "
             "odometry comes from /tf");
  schema.add("frames.laser", &frames.laser, "frame of the scans with `directions.sensors: out`");
}

void describe_directions(ConfigSchema& schema, Settings& settings) {
  Directions& directions = settings.directions;
  const std::vector<std::pair<std::string, Direction>> ways = {
      {"in", Direction::kIn}, {"out", Direction::kOut}, {"off", Direction::kOff}};
  schema.add("directions.sensors", &directions.sensors, ways,
             "in: scan and odometry come from ROS; out: those of our devices, log or simulator are "
             "published to ROS");
  schema.add("directions.velocity", &directions.velocity, ways,
             "out: our navigator drives the robot of ROS; in: ROS drives our base");
  schema.add("directions.map", &directions.map, "whether map and map_updates are published");
  schema.add("directions.map_to_odom", &directions.map_to_odom,
             "whether map -> odom is published on tf; only one program may do so");
  schema.add("directions.pose", &directions.pose, "whether the pose is published");
  schema.add("directions.plan", &directions.plan, "whether the route is published");
  schema.add("directions.graph", &directions.graph, "whether graph and rooms are published");
  schema.add("directions.initial_pose", &directions.initial_pose,
             "whether initial poses are accepted");
  schema.add("directions.goal", &directions.goal, "whether goals are accepted");
  schema.add("directions.diagnostics", &directions.diagnostics, "whether status is published");
  schema.add("directions.clock", &directions.clock,
             "with `sensors: out`: publish the time of the log, for nodes with use_sim_time");
}

void describe_qos(ConfigSchema& schema, Settings& settings) {
  Settings::QualityOfService& qos = settings.qos;
  const std::vector<std::pair<std::string, ros::Qos>> kinds = {
      {"best_effort", ros::Qos::kBestEffort},
      {"reliable", ros::Qos::kReliable},
      {"latched", ros::Qos::kLatched}};
  schema.add("qos.scan", &qos.scan, kinds,
             "best_effort receives the scans of every driver; lost scans stay lost");
  schema.add("qos.odometry", &qos.odometry, kinds, "the same for odometry");
  schema.add("qos.map", &qos.map, kinds, "latched (transient local): late readers get the map");
  schema.add("qos.velocity", &qos.velocity, kinds, "QoS of the velocity in either direction");
}

/// The absolute name of a topic.
std::string resolved(const std::string& name, const std::string& ros_namespace) {
  if (name.starts_with('/')) return name;
  return ros_namespace + "/" + name;
}

std::string normalized_namespace(const std::string& text) {
  if (text.empty() || text == "/") return {};
  std::string name = text.starts_with('/') ? text : "/" + text;
  ros::check_topic_name(name);
  return name;
}

std::pair<std::string, std::string> split(const std::string& remap) {
  const std::size_t sign = remap.find(":=");
  if (sign == std::string::npos || sign == 0 || sign + 2 == remap.size()) {
    throw std::runtime_error("--remap " + remap + ": expected FROM:=TO");
  }
  return {remap.substr(0, sign), remap.substr(sign + 2)};
}

void remap(Settings::Topics& topics, const SettingOptions& options) {
  std::string ros_namespace = normalized_namespace(options.ros_namespace);
  for (const std::string& text : options.remaps) {
    const auto [from, to] = split(text);
    if (from == "__ns") ros_namespace = normalized_namespace(to);
  }
  std::vector<std::pair<const char*, std::string*>> names = names_of(topics);
  for (const auto& [key, name] : names) *name = resolved(*name, ros_namespace);
  std::vector<bool> remapped(names.size(), false);
  for (const std::string& text : options.remaps) {
    const auto [from, to] = split(text);
    if (from.starts_with("__")) continue;  // __ns; __node: there is no node here
    const std::string whole = resolved(from, ros_namespace);
    bool found = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (remapped[i] || *names[i].second != whole) continue;
      *names[i].second = resolved(to, ros_namespace);
      remapped[i] = found = true;
    }
    if (!found) {
      std::string all;
      for (const auto& [key, name] : names) all.append(" ").append(*name);
      throw std::runtime_error(
          fmt::format("--remap {}: no topic {}, expected one of{}", text, whole, all));
    }
  }
  for (const auto& [key, name] : names) ros::check_topic_name(*name);
}

}  // namespace

ConfigSchema describe(Settings& settings) {
  ConfigSchema schema;
  describe_topics(schema, settings);
  describe_directions(schema, settings);
  describe_qos(schema, settings);
  schema.add("odometry.source", &settings.odometry_source,
             {{"topic", OdometrySource::kTopic},
              {"tf", OdometrySource::kTransforms},
              {"laser", OdometrySource::kLaser}},
             "the topic of the odometry, odom -> robot of /tf, or none: odometry from the scans");
  schema.add("odometry.wait_s", &settings.odometry_wait_s, 0.0, 1.0, "s",
             "longest time that a scan waits for the odometry after it; 0: the scan is published "
             "at once, with the last odometry extrapolated by its speeds");
  schema.add("odometry.longest_extrapolation_s", &settings.longest_extrapolation_s, 0.0, 5.0, "s",
             "a scan later than this after the last odometry is dropped");
  schema.add("laser.mounting_from_tf", &settings.mounting_from_tf,
             "true: the frames of tf give the mounting of the laser; false: only the configuration "
             "of the services does, and the laser is upright");
  schema.add(
      "laser.sweep", &settings.sweep,
      {{"none", ros::SweepOrder::kNone},
       {"forward", ros::SweepOrder::kForward},
       {"backward", ros::SweepOrder::kBackward}},
      "correction of the motion during a scan by time_increment; none: no correction; forward: the "
      "rays come in order; backward: the last ray comes first, as in many clockwise scanners");
  schema.add("velocity.stamped", &settings.stamped_velocity,
             "TwistStamped, the default of Nav2 from Kilted on, in place of Twist");
  schema.add("transforms.tolerance_s", &settings.transform_tolerance_s, 0.0, 5.0, "s",
             "time by which map -> odom is stamped later than it was measured, so that other nodes "
             "need not wait for it");
  schema.add("map.period_s", &settings.map_period_s, 0.1, 600.0, "s",
             "shortest time between two publications of the whole map; changes in between are in "
             "map_updates");
  schema.add("network.localhost_only", &settings.localhost_only,
             "for nodes of Humble with ROS_LOCALHOST_ONLY=1; receives no others");
  return schema;
}

Settings load_settings(const SettingOptions& options) {
  Settings settings;
  if (options.file) support::load_yaml_file(*options.file, describe(settings));
  try {
    remap(settings.topics, options);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(error.what());
  }
  return settings;
}

}  // namespace topogeo::ros_bridge
