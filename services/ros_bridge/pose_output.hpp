// Publishes the pose on the map: topic pose, and map -> odom on tf (REP 105).
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/service/conversions.hpp"

#include "ros_side.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service. Nothing is published while the localizer is searching or lost.
class PoseOutput {
 public:
  explicit PoseOutput(RosSide& ros);
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;
  ~PoseOutput();

  /// Stores the odometry for a pose with that stamp.
  void note_odometry(std::int64_t stamp_ns, std::uint64_t epoch,
                     const geometry::Pose2& T_odom_robot);

  /// Empty while the robot's pose is not known.
  [[nodiscard]] const std::optional<geometry::Pose2>& T_map_robot() const { return T_map_robot_; }
  [[nodiscard]] const std::optional<geometry::Pose2>& T_map_odom() const { return T_map_odom_; }

  /// Checks a transform on tf for a second publisher of map -> odom.
  void check_foreign(const std::string& parent, const std::string& child, std::int64_t stamp_ns);

 private:
  void on_pose(const service::LivePose& pose);
  void publish_transform();

  RosSide& ros_;
  std::optional<messaging::Writer<ros::PoseWithCovarianceStamped>> poses_;
  std::optional<messaging::Writer<ros::TFMessage>> transforms_;
  std::map<std::int64_t, geometry::Pose2> T_odom_robot_;  // recent readings, by their stamps
  std::uint64_t odometry_epoch_ = 0;
  std::optional<geometry::Pose2> T_map_robot_;
  std::optional<geometry::Pose2> T_map_odom_;
  std::optional<service::LivePose> waiting_;  // until its odometry arrives
  std::deque<std::int64_t> sent_ns_;          // stamps of recent transforms
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::ros_bridge
