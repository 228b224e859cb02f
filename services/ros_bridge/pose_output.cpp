#include "pose_output.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/slam/state_monitor.hpp"

#include "outputs.hpp"

namespace topogeo::ros_bridge {
namespace {

/// Consumers of tf expect 20 Hz and more.
constexpr std::chrono::milliseconds kTransformPeriod{25};
/// Covers more than the time that a pose takes to come back.
constexpr std::size_t kReadingsKept = 2000;
constexpr std::size_t kStampsKept = 200;

}  // namespace

PoseOutput::PoseOutput(RosSide& ros) : ros_(ros) {
  const Settings& settings = ros.settings();
  if (settings.directions.pose) {
    poses_ =
        ros.advertise<ros::PoseWithCovarianceStamped>(settings.topics.pose, ros::Qos::kReliable);
  }
  if (settings.directions.map_to_odom) {
    transforms_ = ros.advertise<ros::TFMessage>(settings.topics.tf, ros::Qos::kTransforms);
  }
  service::Service& service = ros.service();
  service.subscribe<msg::LivePose>(
      [this](const msg::LivePose& pose) { on_pose(service::from_msg(pose)); });
  service.status().set_counter("poses_sent", 0.0);
  timer_ = service.loop().add_timer(kTransformPeriod, [this] { publish_transform(); });
}

PoseOutput::~PoseOutput() {
  ros_.service().loop().cancel_timer(timer_);
}

void PoseOutput::note_odometry(std::int64_t stamp_ns, std::uint64_t epoch,
                               const geometry::Pose2& T_odom_robot) {
  if (epoch != odometry_epoch_) {
    T_odom_robot_.clear();
    T_map_odom_.reset();
    odometry_epoch_ = epoch;
  }
  T_odom_robot_[stamp_ns] = T_odom_robot;
  if (T_odom_robot_.size() > kReadingsKept) T_odom_robot_.erase(T_odom_robot_.begin());
  if (!waiting_ || waiting_->stamp_ns > stamp_ns) return;
  const service::LivePose pose = *waiting_;
  waiting_.reset();
  on_pose(pose);
}

void PoseOutput::on_pose(const service::LivePose& pose) {
  if (!localization::located(pose.status.state)) {
    T_map_robot_.reset();
    T_map_odom_.reset();
    return;
  }
  T_map_robot_ = pose.T_map_robot;
  const auto odometry = T_odom_robot_.find(pose.stamp_ns);
  if (odometry == T_odom_robot_.end()) {
    // The pose may have arrived before its odometry.
    if (T_odom_robot_.empty() || T_odom_robot_.rbegin()->first < pose.stamp_ns) waiting_ = pose;
    return;
  }
  T_map_odom_ = correction_of(pose.T_map_robot, odometry->second);
  if (poses_) {
    ros_.send(*poses_, to_ros(pose, ros_.settings().frames.map));
    ros_.service().status().add_to_counter("poses_sent");
  }
}

void PoseOutput::publish_transform() {
  if (!transforms_ || !T_map_odom_) return;
  const Settings& settings = ros_.settings();
  const std::int64_t stamp_ns = ros_.now_ns() + std::llround(settings.transform_tolerance_s * 1e9);
  if (!sent_ns_.empty() && sent_ns_.back() == stamp_ns) return;  // tf accepts each stamp once
  sent_ns_.push_back(stamp_ns);
  if (sent_ns_.size() > kStampsKept) sent_ns_.pop_front();
  ros::TFMessage message;
  message.transforms_().push_back(
      ros::transform_of(settings.frames.map, settings.frames.odom, *T_map_odom_, stamp_ns));
  ros_.send(*transforms_, message);
}

void PoseOutput::check_foreign(const std::string& parent, const std::string& child,
                               std::int64_t stamp_ns) {
  if (!transforms_ || child != ros_.settings().frames.odom) return;
  if (std::ranges::find(sent_ns_, stamp_ns) != sent_ns_.end()) return;
  ros_.complain("second publisher of map -> odom",
                parent + " -> " + child +
                    " is published by another program, for example AMCL or slam_toolbox: end it, "
                    "or set directions.map_to_odom: false");
}

}  // namespace topogeo::ros_bridge
