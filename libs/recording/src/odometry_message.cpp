#include "odometry_message.hpp"

#include "topogeo/recording/message_source.hpp"
#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::recording {
namespace {

constexpr std::string_view kPoseStampedType = "geometry_msgs/msg/PoseStamped";
constexpr std::string_view kPoseWithCovarianceType = "geometry_msgs/msg/PoseWithCovarianceStamped";
constexpr std::string_view kTransformType = "geometry_msgs/msg/TransformStamped";

}  // namespace

bool states_pose(std::string_view type) {
  return type == kOdometryType || type == kPoseStampedType || type == kPoseWithCovarianceType ||
         type == kTransformType;
}

OdometryMessage decode_odometry(std::string_view type, std::span<const std::byte> bytes,
                                Encoding encoding) {
  if (type == kPoseStampedType) {
    const auto stated = decode<ros::PoseStamped>(bytes, encoding);
    return {stated.header_(), {}, ros::planar(stated.pose_())};
  }
  if (type == kPoseWithCovarianceType) {
    const auto stated = decode<ros::PoseWithCovarianceStamped>(bytes, encoding);
    return {stated.header_(), {}, ros::planar(stated.pose_().pose_())};
  }
  if (type == kTransformType) {
    const auto stated = decode<ros::TransformStamped>(bytes, encoding);
    return {stated.header_(), ros::frame_name(stated.child_frame_id_()),
            ros::planar(stated.transform_())};
  }
  const auto stated = decode<ros::Odometry>(bytes, encoding);
  return {stated.header_(), ros::frame_name(stated.child_frame_id_()),
          ros::planar(stated.pose_().pose_())};
}

}  // namespace topogeo::recording
