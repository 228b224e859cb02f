// The robot on the hub: pose, scan, activity, route, devices.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/simulation.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/service/service.hpp"

#include "channels/map_picture.hpp"
#include "channels/scan_fit.hpp"
#include "server/channel_hub.hpp"

namespace topogeo::web {

class EventLog;

/// Callbacks for other users of the view's data; each may be empty.
struct RobotHooks {
  std::function<void(const navigation::ScanPoints&)> on_scan;
  std::function<void(const msg::LivePose&)> on_pose;
  std::function<void(const msg::NavigatorStatus&, const messaging::SampleInfo&)> on_navigator;
  /// The map that scans are compared with; null before the first one.
  std::function<std::shared_ptr<const MapPicture>()> map;
  /// Charge of the battery in [0, 100]; empty unless the base measures it.
  std::function<std::optional<double>()> battery_percent;
};

/// Lives in the loop of its service.
class RobotView {
 public:
  RobotView(service::Service& service, ChannelHub& hub, EventLog& events, RobotHooks hooks = {});

  /// The newest pose; it is meaningful only in TRACKING and AMBIGUOUS.
  [[nodiscard]] const std::optional<msg::LivePose>& pose() const { return pose_; }

 private:
  /// `sent_ns`: wall clock of the sender.
  void on_pose(const msg::LivePose& pose, std::int64_t sent_ns);
  void on_scan(const msg::Scan& message);
  /// Shows the scan with its own pose, or without one when none has arrived in time.
  void show_scan();
  /// Whether the scan fits the finished map at the pose; nothing while that is not known.
  std::optional<bool> fits(const navigation::ScanPoints& scan, const geometry::Pose2& T_map_robot);
  void on_navigator(const msg::NavigatorStatus& status, const messaging::SampleInfo& info);
  void on_route(const msg::Route& route);
  void on_base(const msg::BaseStatus& status);
  void on_laser(const msg::LaserStatus& status);
  void on_truth(const msg::GroundTruth& truth);

  ChannelHub& hub_;
  EventLog& events_;
  RobotHooks hooks_;
  service::Service& service_;
  std::optional<msg::LivePose> pose_;
  double pose_came_s_ = 0.0;                    // by the steady clock
  std::optional<navigation::ScanPoints> scan_;  // not yet shown
  std::uint64_t scan_sequence_ = 0;
  ScanFit fit_;
  std::optional<msg::NavigatorState> navigator_state_;
  std::optional<msg::BaseState> base_state_;
  std::optional<msg::LaserState> laser_state_;
  bool battery_low_ = false;
};

}  // namespace topogeo::web
