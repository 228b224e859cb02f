// Settings of the bridge: names, frames, quality of service and directions of the ROS topics.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/ros_conversions/laser_scan.hpp"
#include "topogeo/ros_messaging/topic.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::ros_bridge {

enum class Direction { kIn, kOut, kOff };
enum class OdometrySource { kTopic, kTransforms, kLaser };

/// The direction of each topic, in from ROS or out to it.
struct Directions {
  Direction sensors = Direction::kIn;
  Direction velocity = Direction::kOff;
  bool map = false;
  bool map_to_odom = false;
  bool pose = false;
  bool plan = false;
  bool graph = false;
  bool initial_pose = false;
  bool goal = false;
  bool diagnostics = false;
  bool clock = false;
};

/// Same structure as the file. Topic names are relative to the namespace unless they begin with
/// '/'.
struct Settings {
  struct Topics {
    std::string scan = "scan";
    std::string odometry = "odom";
    std::string tf = "/tf";
    std::string tf_static = "/tf_static";
    std::string map = "map";
    std::string map_updates = "map_updates";
    std::string pose = "pose";
    std::string plan = "plan";
    std::string graph = "graph";
    std::string rooms = "rooms";
    std::string velocity = "cmd_vel";
    std::string initial_pose = "initialpose";
    std::string goal = "goal_pose";
    std::string diagnostics = "/diagnostics";
    std::string clock = "/clock";
  } topics;
  struct Frames {
    std::string map = "map";
    std::string odom = "odom";
    std::string robot;  ///< empty: the frame named by odometry; base_link with odometry from /tf
    std::string laser = "laser";  ///< of the scans that we publish
  } frames;
  struct QualityOfService {
    ros::Qos scan = ros::Qos::kBestEffort;
    ros::Qos odometry = ros::Qos::kBestEffort;
    ros::Qos map = ros::Qos::kLatched;
    ros::Qos velocity = ros::Qos::kReliable;
  } qos;
  /// Everything is on unless the file says otherwise.
  Directions directions{
      Direction::kIn, Direction::kOut, true, true, true, true, true, true, true, true, false};
  OdometrySource odometry_source = OdometrySource::kTopic;
  double odometry_wait_s = 0.0;
  double longest_extrapolation_s = 0.5;
  bool mounting_from_tf = true;
  ros::SweepOrder sweep = ros::SweepOrder::kNone;
  bool stamped_velocity = false;
  double transform_tolerance_s = 0.2;
  double map_period_s = 5.0;
  bool localhost_only = false;
};

/// Declares every key with its variable in `settings`, its range, unit and reason.
support::ConfigSchema describe(Settings& settings);

/// Command-line options, which override the file.
struct SettingOptions {
  std::optional<std::filesystem::path> file;
  std::vector<std::string> remaps;  ///< FROM:=TO, __ns:=NAMESPACE
  std::string ros_namespace;        ///< empty: none
};

/// The settings of the file, with namespace and remappings applied to every topic name. Throws
/// std::runtime_error naming file, key or remapping and what was expected.
Settings load_settings(const SettingOptions& options);

}  // namespace topogeo::ros_bridge
