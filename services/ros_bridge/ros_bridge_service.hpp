// Joins a robot that speaks ROS 2 with the services of topogeo.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/status.h"

#include "map_output.hpp"
#include "order_input.hpp"
#include "pose_output.hpp"
#include "ros_side.hpp"
#include "sensor_input.hpp"
#include "sensor_output.hpp"
#include "velocity_bridge.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service; each part is made as the settings want it.
class RosBridgeService {
 public:
  /// `ros_domain`: DDS domain of the ROS nodes. Throws like RosSide.
  RosBridgeService(service::Service& service, const Settings& settings, std::uint32_t ros_domain,
                   bool replay);
  RosBridgeService(const RosBridgeService&) = delete;
  RosBridgeService& operator=(const RosBridgeService&) = delete;

  /// After the loop: readers of scans hear that they end.
  void finish();

  /// Where the laser is, once it is known; with sensors of ROS.
  [[nodiscard]] std::optional<ros::LaserMounting> mounting() const;

 private:
  /// Where sensors are ours.
  void listen_to_odometry(bool replay);
  void publish_plan(const msg::Route& route);
  void publish_diagnostics();

  RosSide ros_;
  PoseOutput pose_;
  OrderInput orders_;
  VelocityBridge velocity_;
  MapOutput map_;
  std::optional<SensorInput> sensors_in_;
  std::optional<SensorOutput> sensors_out_;
  std::optional<messaging::Writer<ros::Path>> plans_;
  std::optional<messaging::Writer<ros::DiagnosticArray>> diagnostics_;
  std::map<messaging::Handle, msg::ServiceStatus> services_;
};

}  // namespace topogeo::ros_bridge
