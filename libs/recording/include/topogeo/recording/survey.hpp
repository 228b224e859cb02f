// Content of a recording for mapping: the topics of scans and odometry, and the mounting of the
// laser.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/ros_conversions/frame_tree.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"

namespace topogeo::recording {

/// The user's choices; all are optional.
struct TopicChoice {
  std::optional<std::string>
      scan;  ///< of sensor_msgs/LaserScan; none: of a level laser, /scan, else most messages
  std::optional<std::string>
      odometry;  ///< of nav_msgs/Odometry or tf2_msgs/TFMessage; none: of the robot with the
                 ///< scans, /odom, else the Odometry with most messages, else odom -> base of /tf
  ros::SweepOrder sweep = ros::SweepOrder::kNone;  ///< removes the motion during a scan
};

struct Survey {
  std::string scan_topic;
  std::string laser_frame;
  std::uint64_t scans = 0;  ///< messages of that topic
  bool ranges_in_millimetres = false;
  std::string odometry_topic;
  bool odometry_from_tf = false;
  std::string odom_frame;
  std::string odometry_child_frame;  ///< as its messages state it
  std::string robot_frame;           ///< whose motion odometry measures
  std::optional<ros::LaserMounting>
      mounting;  ///< empty if no transforms connect robot_frame and laser_frame
  std::optional<ros::BeamPattern> beams;  ///< of most scans; empty if none has beams
  /// For people, a line each: the chosen topics and the state of the mounting.
  std::vector<std::string> notes;
};

/// Reads the whole recording once. Throws std::runtime_error naming the file and the expectation:
/// no recording, no scans, no odometry, a chosen topic that does not exist.
Survey survey(const std::filesystem::path& path, const TopicChoice& choice);

}  // namespace topogeo::recording
