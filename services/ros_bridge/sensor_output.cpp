#include "sensor_output.hpp"

#include <string>

#include "topogeo/messaging/topics.hpp"
#include "topogeo/ros_conversions/geometry.hpp"

#include "outputs.hpp"

namespace topogeo::ros_bridge {

SensorOutput::SensorOutput(RosSide& ros, bool replay)
    : ros_(ros),
      robot_frame_(ros.settings().frames.robot.empty() ? "base_link" : ros.settings().frames.robot),
      scans_(ros.advertise<ros::LaserScan>(ros.settings().topics.scan, ros::Qos::kReliable)),
      odometry_(ros.advertise<ros::Odometry>(ros.settings().topics.odometry, ros::Qos::kReliable)),
      transforms_(ros.advertise<ros::TFMessage>(ros.settings().topics.tf, ros::Qos::kTransforms)),
      static_transforms_(
          ros.advertise<ros::TFMessage>(ros.settings().topics.tf_static, ros::Qos::kLatched)),
      replay_(replay) {
  if (ros.settings().directions.clock) {
    clock_ = ros.advertise<ros::Clock>(ros.settings().topics.clock, ros::Qos::kReliable);
  }
  const std::string role = replay ? std::string(messaging::kReplayRole) : std::string();
  service::Service& service = ros.service();
  service.subscribe<msg::Odometry>([this](const msg::Odometry& odometry) { on_odometry(odometry); },
                                   {.role = role});
  service.subscribe<msg::Scan>(
      [this](const msg::Scan& scan) { on_scan(scan); },
      {.role = role, .read_with = {messaging::kOdometry}, .main_input = true});
  service.status().wait_for("scans");
}

void SensorOutput::publish_time(std::int64_t stamp_ns) {
  if (stamp_ns <= ros_.now_ns()) return;
  ros_.set_now(stamp_ns);
  if (!clock_) return;
  ros::Clock clock;
  clock.clock_(ros::time_of(stamp_ns));
  ros_.send(*clock_, clock);
}

void SensorOutput::publish_mounting(std::int64_t stamp_ns) {
  mounting_sent_ = true;
  ros::TFMessage message;
  message.transforms_().push_back(
      ros::transform_of(robot_frame_, ros_.settings().frames.laser,
                        ros_.service().setup().config.config.local_mapper.T_robot_laser, stamp_ns));
  ros_.send(static_transforms_, message);
}

bool SensorOutput::is_repeated(std::uint64_t odometry_epoch, std::int64_t stamp_ns,
                               Last& last) const {
  if (replay_ && last.odometry_epoch == odometry_epoch && last.stamp_ns >= stamp_ns) return true;
  last = {odometry_epoch, stamp_ns};
  return false;
}

void SensorOutput::on_scan(const msg::Scan& scan) {
  if (is_repeated(scan.odometry_epoch(), scan.stamp_ns(), last_scan_)) return;
  if (ros_.service().status().state() != msg::kServiceRunning) {
    ros_.service().status().set_state(msg::kServiceRunning);
  }
  if (!mounting_sent_) publish_mounting(scan.stamp_ns());
  publish_time(scan.stamp_ns());
  const auto longest_m = static_cast<float>(ros_.service().setup().config.config.log.range_max_m);
  ros_.send(scans_, to_ros(scan, ros_.settings().frames.laser, longest_m));
}

void SensorOutput::on_odometry(const msg::Odometry& odometry) {
  if (is_repeated(odometry.odometry_epoch(), odometry.stamp_ns(), last_odometry_)) return;
  publish_time(odometry.stamp_ns());
  const std::string& odom = ros_.settings().frames.odom;
  ros_.send(odometry_, to_ros(odometry, odom, robot_frame_));
  ros::TFMessage message;
  message.transforms_().push_back(ros::transform_of(
      odom, robot_frame_, service::from_msg(odometry.T_odom_robot()), odometry.stamp_ns()));
  ros_.send(transforms_, message);
}

}  // namespace topogeo::ros_bridge
