#include "ros_robot.hpp"

#include <algorithm>
#include <cmath>

#include "nav_msgs.h"
#include "ros_messages.hpp"
#include "sensor_msgs.h"
#include "tf2_msgs.h"

namespace topogeo::test {

RosRobot::RosRobot(std::uint32_t domain)
    : peer_(domain),
      scans_(peer_.writer(sensor_msgs_msg_dds__LaserScan__desc, "/scan", PeerQos::kReliable)),
      odometry_(peer_.writer(nav_msgs_msg_dds__Odometry__desc, "/odom", PeerQos::kReliable)),
      static_(peer_.writer(tf2_msgs_msg_dds__TFMessage__desc, "/tf_static", PeerQos::kLatched)),
      poses_(peer_.reader(geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc, "/pose",
                          PeerQos::kReliable)),
      velocities_(
          peer_.reader(geometry_msgs_msg_dds__Twist__desc, "/cmd_vel", PeerQos::kReliable)) {
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  transform.header_ = header(kBase, kStart_ns);
  transform.child_frame_id_ = kLaser;
  transform.transform_.rotation_.w_ = 1.0;
  tf2_msgs_msg_dds__TFMessage_ message{};
  message.transforms_._length = message.transforms_._maximum = 1;
  message.transforms_._buffer = &transform;
  write(static_, message);
}

bool RosRobot::has_bridge() const {
  return has_reader(scans_) && has_reader(odometry_);
}

void RosRobot::send_odometry(std::int64_t at_ns, const geometry::Pose2& T_odom_robot,
                             double linear_mps, double angular_radps) const {
  nav_msgs_msg_dds__Odometry_ message{};
  message.header_ = header(kOdom, at_ns);
  message.child_frame_id_ = kBase;
  message.pose_.pose_.position_.x_ = T_odom_robot.x_m;
  message.pose_.pose_.position_.y_ = T_odom_robot.y_m;
  message.pose_.pose_.orientation_ = quaternion(T_odom_robot.theta_rad);
  message.twist_.twist_.linear_.x_ = linear_mps;
  message.twist_.twist_.angular_.z_ = angular_radps;
  write(odometry_, message);
}

void RosRobot::send_scan(std::int64_t at_ns, double angle_min_rad, double angle_step_rad,
                         std::vector<float> ranges_m) const {
  sensor_msgs_msg_dds__LaserScan_ message{};
  message.header_ = header(kLaser, at_ns);
  message.angle_min_ = static_cast<float>(angle_min_rad);
  message.angle_increment_ = static_cast<float>(angle_step_rad);
  message.angle_max_ = static_cast<float>(
      angle_min_rad + angle_step_rad * (static_cast<double>(ranges_m.size()) - 1.0));
  message.range_min_ = 0.01F;
  message.range_max_ = 80.0F;
  for (float& range_m : ranges_m) {
    if (range_m == 0.0F) range_m = INFINITY;
  }
  message.ranges_._length = message.ranges_._maximum = static_cast<std::uint32_t>(ranges_m.size());
  message.ranges_._buffer = ranges_m.data();
  write(scans_, message);
}

std::int64_t RosRobot::last_pose_ns() {
  take<PoseMessage>(poses_, [this](const PoseMessage& pose) {
    last_pose_ns_ = std::max(last_pose_ns_, stamp_ns(pose.header_));
  });
  return last_pose_ns_;
}

std::optional<simulation::Velocity> RosRobot::velocity() {
  std::optional<simulation::Velocity> last;
  take<geometry_msgs_msg_dds__Twist_>(velocities_, [&](const geometry_msgs_msg_dds__Twist_& twist) {
    last = simulation::Velocity{twist.linear_.x_, twist.angular_.z_};
  });
  return last;
}

}  // namespace topogeo::test
