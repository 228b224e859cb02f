#include "odometry_samples.hpp"

#include <cmath>

#include "topogeo/messaging/message.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::ros_bridge {
namespace {

/// No indoor robot is as fast, and a pose extrapolated by such speeds stays finite.
bool plausible(double linear_mps, double angular_radps) {
  constexpr double kMostMps = 100.0;
  constexpr double kMostRadps = 100.0;
  return std::fabs(linear_mps) <= kMostMps && std::fabs(angular_radps) <= kMostRadps;
}

}  // namespace

std::optional<geometry::OdometrySample> to_sample(const ros::Odometry& message) {
  const auto T_odom_robot = ros::planar(message.pose_().pose_());
  const double linear_mps = message.twist_().twist_().linear_().x_();
  const double angular_radps = message.twist_().twist_().angular_().z_();
  if (!T_odom_robot || !plausible(linear_mps, angular_radps)) return std::nullopt;
  return geometry::OdometrySample{ros::stamp_ns_of(message.header_().stamp_()), *T_odom_robot,
                                  linear_mps, angular_radps};
}

std::optional<geometry::OdometrySample> to_sample(
    const ros::TransformStamped& message, const std::optional<geometry::OdometrySample>& last) {
  const auto T_odom_robot = ros::planar(message.transform_());
  if (!T_odom_robot) return std::nullopt;
  geometry::OdometrySample sample{ros::stamp_ns_of(message.header_().stamp_()), *T_odom_robot, 0.0,
                                  0.0};
  if (!last || sample.stamp_ns <= last->stamp_ns) return sample;
  const double passed_s = static_cast<double>(sample.stamp_ns - last->stamp_ns) * 1e-9;
  const geometry::Pose2 moved = geometry::between(last->T_odom_robot, sample.T_odom_robot);
  const double linear_mps = moved.x_m / passed_s;
  const double angular_radps = moved.theta_rad / passed_s;
  if (!plausible(linear_mps, angular_radps)) return sample;
  sample.linear_mps = linear_mps;
  sample.angular_radps = angular_radps;
  return sample;
}

msg::Odometry to_msg(const geometry::OdometrySample& sample, std::string_view robot_id,
                     std::uint64_t epoch, std::uint64_t sequence_number) {
  msg::Odometry message;
  messaging::set_header(message, robot_id, sample.stamp_ns, sequence_number);
  message.T_odom_robot(service::to_msg(sample.T_odom_robot));
  message.odometry_epoch(epoch);
  message.linear_mps(sample.linear_mps);
  message.angular_radps(sample.angular_radps);
  return message;
}

}  // namespace topogeo::ros_bridge
