// Content of a recording for mapping: the topics of scans and odometry, and the mounting of the
// laser.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/frame_tree.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"

namespace topogeo::recording {

/// Whether the odometry of a recording is wanted.
enum class OdometryUse : std::uint8_t {
  kRequired,    ///< a recording without odometry is refused
  kIfRecorded,  ///< without odometry all scans have the identity
  kIgnored      ///< so have they with it
};

/// The user's choices; all are optional.
struct TopicChoice {
  std::optional<std::string>
      scan;  ///< of sensor_msgs/LaserScan; none: of a level laser, /scan, else most messages
  std::optional<std::string>
      odometry;  ///< of nav_msgs/Odometry, tf2_msgs/TFMessage, or PoseStamped,
                 ///< PoseWithCovarianceStamped or TransformStamped of geometry_msgs; none: of the
                 ///< robot with the scans, /odom, else the Odometry with most messages, else
                 ///< odom -> base of /tf
  ros::SweepOrder sweep = ros::SweepOrder::kNone;  ///< removes the motion during a scan
  OdometryUse odometry_use = OdometryUse::kRequired;
  std::optional<geometry::Pose2> T_robot_laser =
      std::nullopt;          ///< mounting where the log states none
  bool upside_down = false;  ///< the laser is, whatever transforms state; also for a CARMEN log
  /// Time by which the stamps of scans are later than those of odometry, s; none: as stated.
  std::optional<double> scan_delay_s = std::nullopt;
};

struct Survey {
  std::string scan_topic;
  std::string laser_frame;
  std::uint64_t scans = 0;  ///< messages of that topic
  bool ranges_in_millimetres = false;
  std::string odometry_topic;  ///< empty: none, by TopicChoice::odometry_use
  std::string odometry_type;   ///< Topic::type of its messages
  std::string odom_frame;
  std::string odometry_child_frame;  ///< as its messages state it
  std::string robot_frame;           ///< whose motion odometry measures, or that of the laser
  std::optional<ros::LaserMounting> mounting;  ///< empty if no transforms connect robot_frame and
                                               ///< laser_frame, without a choice
  bool upside_down = false;               ///< scans are mirrored, by the mounting or the choice
  std::optional<ros::BeamPattern> beams;  ///< of most scans; empty if none has beams
  /// For people, a line each: the chosen topics and the state of the mounting.
  std::vector<std::string> notes;
};

/// Reads the whole recording once. Throws std::runtime_error naming the file and the expectation:
/// no recording, no scans, no odometry, a chosen topic that does not exist.
Survey survey(const std::filesystem::path& path, const TopicChoice& choice);

}  // namespace topogeo::recording
