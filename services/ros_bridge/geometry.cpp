#include "geometry.hpp"

#include <cmath>

namespace topogeo::ros_bridge {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kShortestQuaternion = 1e-3;

}  // namespace

std::int64_t from_ros(const ros::Time& time) {
  return static_cast<std::int64_t>(time.sec_()) * kSecond_ns +
         static_cast<std::int64_t>(time.nanosec_());
}

ros::Time to_ros(std::int64_t stamp_ns) {
  std::int64_t seconds = stamp_ns / kSecond_ns;
  if (stamp_ns % kSecond_ns < 0) --seconds;
  ros::Time time;
  time.sec_(static_cast<std::int32_t>(seconds));
  time.nanosec_(static_cast<std::uint32_t>(stamp_ns - seconds * kSecond_ns));
  return time;
}

std::string frame_name(const std::string& frame_id) {
  return frame_id.starts_with('/') ? frame_id.substr(1) : frame_id;
}

ros::Header header_of(const std::string& frame, std::int64_t stamp_ns) {
  ros::Header header;
  header.frame_id_(frame);
  header.stamp_(to_ros(stamp_ns));
  return header;
}

ros::Quaternion rotation_of(double yaw_rad) {
  ros::Quaternion rotation;
  rotation.z_(std::sin(yaw_rad / 2.0));
  rotation.w_(std::cos(yaw_rad / 2.0));
  return rotation;
}

ros::Pose to_ros(const geometry::Pose2& pose) {
  ros::Pose out;
  out.position_().x_(pose.x_m);
  out.position_().y_(pose.y_m);
  out.orientation_(rotation_of(pose.theta_rad));
  return out;
}

std::optional<Eigen::Quaterniond> rotation_from(const ros::Quaternion& rotation) {
  const Eigen::Quaterniond q(rotation.w_(), rotation.x_(), rotation.y_(), rotation.z_());
  const double norm = q.norm();
  if (!std::isfinite(norm) || norm < kShortestQuaternion) return std::nullopt;
  return q.normalized();
}

std::optional<geometry::Pose2> planar(const ros::Pose& pose) {
  const auto rotation = rotation_from(pose.orientation_());
  const double x_m = pose.position_().x_();
  const double y_m = pose.position_().y_();
  if (!rotation || !std::isfinite(x_m) || !std::isfinite(y_m)) return std::nullopt;
  const Eigen::Vector3d axis = *rotation * Eigen::Vector3d::UnitX();
  return geometry::Pose2{x_m, y_m, std::atan2(axis.y(), axis.x())};
}

std::optional<Eigen::Isometry3d> isometry_from(const ros::TransformStamped& transform) {
  const auto& translation = transform.transform_().translation_();
  const Eigen::Vector3d offset_m(translation.x_(), translation.y_(), translation.z_());
  const auto rotation = rotation_from(transform.transform_().rotation_());
  if (!rotation || !offset_m.allFinite()) return std::nullopt;
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = rotation->toRotationMatrix();
  out.translation() = offset_m;
  return out;
}

geometry::Pose2 planar(const Eigen::Isometry3d& transform) {
  const Eigen::Vector3d axis = transform.linear().col(0);
  return {transform.translation().x(), transform.translation().y(), std::atan2(axis.y(), axis.x())};
}

ros::TransformStamped to_transform(const std::string& parent, const std::string& child,
                                   const geometry::Pose2& T_parent_child, std::int64_t stamp_ns) {
  ros::TransformStamped out;
  out.header_(header_of(parent, stamp_ns));
  out.child_frame_id_(child);
  out.transform_().translation_().x_(T_parent_child.x_m);
  out.transform_().translation_().y_(T_parent_child.y_m);
  out.transform_().rotation_(rotation_of(T_parent_child.theta_rad));
  return out;
}

}  // namespace topogeo::ros_bridge
