// Publishes our scans and odometry to ROS, for robots with devices, logs or simulators of ours.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"

#include "ros_side.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service. Publishes scan, odometry, odom -> robot on tf, robot -> laser
/// on tf_static and, if set so, the time of the stamps as clock.
class SensorOutput {
 public:
  /// `replay`: the gateway replays a log.
  SensorOutput(RosSide& ros, bool replay);

 private:
  /// The newest message of a topic.
  struct Last {
    std::uint64_t odometry_epoch = 0;
    std::optional<std::int64_t> stamp_ns;
  };
  /// Whether a log that is read again repeats this message; if not, it becomes the newest.
  [[nodiscard]] bool is_repeated(std::uint64_t odometry_epoch, std::int64_t stamp_ns,
                                 Last& last) const;
  void on_scan(const msg::Scan& scan);
  void on_odometry(const msg::Odometry& odometry);
  void publish_mounting(std::int64_t stamp_ns);
  void publish_time(std::int64_t stamp_ns);

  RosSide& ros_;
  std::string robot_frame_;
  messaging::Writer<ros::LaserScan> scans_;
  messaging::Writer<ros::Odometry> odometry_;
  messaging::Writer<ros::TFMessage> transforms_;
  messaging::Writer<ros::TFMessage> static_transforms_;
  std::optional<messaging::Writer<ros::Clock>> clock_;
  bool mounting_sent_ = false;
  bool replay_;
  Last last_scan_;
  Last last_odometry_;
};

}  // namespace topogeo::ros_bridge
