#include "ros_bridge_service.hpp"

#include <algorithm>
#include <chrono>

#include "topogeo/ros_conversions/geometry.hpp"

#include "outputs.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr std::chrono::seconds kDiagnosticsPeriod{1};  // as aggregators expect

}  // namespace

RosBridgeService::RosBridgeService(service::Service& service, const Settings& settings,
                                   std::uint32_t ros_domain, bool replay)
    : ros_(service, settings, ros_domain),
      pose_(ros_),
      orders_(ros_, pose_),
      velocity_(ros_),
      map_(ros_) {
  if (settings.directions.sensors == Direction::kIn) {
    sensors_in_.emplace(ros_);
    sensors_in_->on_reading = [this](std::int64_t stamp_ns, std::uint64_t epoch,
                                     const geometry::Pose2& T_odom_robot) {
      pose_.note_odometry(stamp_ns, epoch, T_odom_robot);
    };
    sensors_in_->on_foreign_transform = [this](const std::string& parent, const std::string& child,
                                               std::int64_t stamp_ns) {
      pose_.check_foreign(parent, child, stamp_ns);
    };
  } else if (settings.directions.sensors == Direction::kOut) {
    sensors_out_.emplace(ros_, replay);
  } else {
    service.status().set_state(msg::kServiceRunning);
  }
  if (!sensors_in_) listen_to_odometry(replay);
  if (settings.directions.plan) {
    plans_ = ros_.advertise<ros::Path>(settings.topics.plan, ros::Qos::kReliable);
    service.subscribe<msg::Route>([this](const msg::Route& route) { publish_plan(route); });
  }
  if (!settings.directions.diagnostics) return;
  diagnostics_ =
      ros_.advertise<ros::DiagnosticArray>(settings.topics.diagnostics, ros::Qos::kReliable);
  service.subscribe<msg::ServiceStatus>(
      [this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        const std::string robot = status.robot_id().to_string();
        if (robot.empty() || robot == ros_.service().robot_id()) services_[info.instance] = status;
      },
      {.any_robot = true},
      [this](const messaging::SampleInfo& info) { services_.erase(info.instance); });
  service.loop().add_timer(kDiagnosticsPeriod, [this] { publish_diagnostics(); });
}

void RosBridgeService::listen_to_odometry(bool replay) {
  ros_.service().subscribe<msg::Odometry>(
      [this](const msg::Odometry& odometry) {
        ros_.set_now(std::max(ros_.now_ns(), odometry.stamp_ns()));
        pose_.note_odometry(odometry.stamp_ns(), odometry.odometry_epoch(),
                            service::from_msg(odometry.T_odom_robot()));
      },
      {.role = replay ? std::string(messaging::kReplayRole) : std::string()});
}

void RosBridgeService::publish_plan(const msg::Route& route) {
  ros_.send(*plans_, to_path(route, ros_.settings().frames.map));
}

void RosBridgeService::publish_diagnostics() {
  ros::DiagnosticArray array;
  array.header_(ros::header_of("", ros_.now_ns()));
  for (const auto& [instance, status] : services_) array.status_().push_back(to_ros(status));
  ros_.send(*diagnostics_, array);
}

void RosBridgeService::finish() {
  // First, because scan readers may take seconds to answer while the base drives on.
  velocity_.stop();
  if (sensors_in_) sensors_in_->finish();
}

std::optional<ros::LaserMounting> RosBridgeService::mounting() const {
  return sensors_in_ ? sensors_in_->intake().mounting() : std::nullopt;
}

}  // namespace topogeo::ros_bridge
