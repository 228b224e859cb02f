// Connects a robot that speaks ROS 2 to the services of topogeo.
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

/// Lives in the loop of its service; the settings select which parts are created.
class RosBridgeService {
 public:
  /// `ros_domain`: DDS domain of the ROS nodes. Throws like RosSide.
  RosBridgeService(service::Service& service, const Settings& settings, std::uint32_t ros_domain,
                   bool replay);
  RosBridgeService(const RosBridgeService&) = delete;
  RosBridgeService& operator=(const RosBridgeService&) = delete;

  /// Call it after the loop: reports the end of the stream to scan readers.
  void finish();

  /// Mounting of the laser, once it is known; only with sensors of ROS.
  [[nodiscard]] std::optional<ros::LaserMounting> mounting() const;

 private:
  /// With our own sensors.
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
