#include "topogeo/recording/ros_codec.hpp"

#include "topogeo/ros_conversions/messages.hpp"

#include "field_codec.hpp"

namespace topogeo::recording {

// The templates of field_codec.hpp find these through argument-dependent lookup, so they are not in
// an anonymous namespace.

/// A message that is read, or one that is written.
template <typename Type, typename Message>
concept Is = std::same_as<std::remove_const_t<Type>, Message>;

void fields(auto& field, Is<ros::Time> auto& m) {
  field(m.sec_());
  field(m.nanosec_());
}

void fields(auto& field, Is<ros::Duration> auto& m) {
  field(m.sec_());
  field(m.nanosec_());
}

void fields(auto& field, Is<ros::Header> auto& m) {
  field.ros1_sequence();
  fields(field, m.stamp_());
  field(m.frame_id_());
}

void fields(auto& field, Is<ros::ColorRgba> auto& m) {
  field(m.r_());
  field(m.g_());
  field(m.b_());
  field(m.a_());
}

template <typename Message>
concept ThreeNumbers = Is<Message, ros::Point> || Is<Message, ros::Vector3>;

void fields(auto& field, ThreeNumbers auto& m) {
  field(m.x_());
  field(m.y_());
  field(m.z_());
}

void fields(auto& field, Is<ros::Quaternion> auto& m) {
  field(m.x_());
  field(m.y_());
  field(m.z_());
  field(m.w_());
}

void fields(auto& field, Is<ros::Pose> auto& m) {
  fields(field, m.position_());
  fields(field, m.orientation_());
}

void fields(auto& field, Is<ros::PoseStamped> auto& m) {
  fields(field, m.header_());
  fields(field, m.pose_());
}

void fields(auto& field, Is<ros::PoseWithCovariance> auto& m) {
  fields(field, m.pose_());
  field(m.covariance_());
}

void fields(auto& field, Is<ros::PoseWithCovarianceStamped> auto& m) {
  fields(field, m.header_());
  fields(field, m.pose_());
}

void fields(auto& field, Is<ros::Transform> auto& m) {
  fields(field, m.translation_());
  fields(field, m.rotation_());
}

void fields(auto& field, Is<ros::TransformStamped> auto& m) {
  fields(field, m.header_());
  field(m.child_frame_id_());
  fields(field, m.transform_());
}

void fields(auto& field, Is<ros::Twist> auto& m) {
  fields(field, m.linear_());
  fields(field, m.angular_());
}

void fields(auto& field, Is<ros::TwistWithCovariance> auto& m) {
  fields(field, m.twist_());
  field(m.covariance_());
}

void fields(auto& field, Is<ros::LaserScan> auto& m) {
  fields(field, m.header_());
  field(m.angle_min_());
  field(m.angle_max_());
  field(m.angle_increment_());
  field(m.time_increment_());
  field(m.scan_time_());
  field(m.range_min_());
  field(m.range_max_());
  field(m.ranges_());
  field(m.intensities_());
}

void fields(auto& field, Is<ros::CompressedImage> auto& m) {
  fields(field, m.header_());
  field(m.format_());
  field(m.data_());
}

void fields(auto& field, Is<ros::Odometry> auto& m) {
  fields(field, m.header_());
  field(m.child_frame_id_());
  fields(field, m.pose_());
  fields(field, m.twist_());
}

void fields(auto& field, Is<ros::MapMetaData> auto& m) {
  fields(field, m.map_load_time_());
  field(m.resolution_());
  field(m.width_());
  field(m.height_());
  fields(field, m.origin_());
}

void fields(auto& field, Is<ros::OccupancyGrid> auto& m) {
  fields(field, m.header_());
  fields(field, m.info_());
  field(m.data_());
}

void fields(auto& field, Is<ros::TFMessage> auto& m) {
  field(m.transforms_());
}

void fields(auto& field, Is<ros::UvCoordinate> auto& m) {
  field(m.u_());
  field(m.v_());
}

void fields(auto& field, Is<ros::MeshFile> auto& m) {
  field(m.filename_());
  field(m.data_());
}

void fields(auto& field, Is<ros::Marker> auto& m) {
  fields(field, m.header_());
  field(m.ns_());
  field(m.id_());
  field(m.type_());
  field(m.action_());
  fields(field, m.pose_());
  fields(field, m.scale_());
  fields(field, m.color_());
  fields(field, m.lifetime_());
  field(m.frame_locked_());
  field(m.points_());
  field(m.colors_());
  field(m.texture_resource_());
  fields(field, m.texture_());
  field(m.uv_coordinates_());
  field(m.text_());
  field(m.mesh_resource_());
  fields(field, m.mesh_file_());
  field(m.mesh_use_embedded_materials_());
}

void fields(auto& field, Is<ros::MarkerArray> auto& m) {
  field(m.markers_());
}

template <typename Message>
constexpr bool kInRos1 =
    std::same_as<Message, ros::LaserScan> || std::same_as<Message, ros::Odometry> ||
    std::same_as<Message, ros::TFMessage> || std::same_as<Message, ros::PoseStamped> ||
    std::same_as<Message, ros::PoseWithCovarianceStamped> ||
    std::same_as<Message, ros::TransformStamped>;

template <typename Message>
Message decode(std::span<const std::byte> bytes, Encoding encoding) {
  Message message;
  if (encoding == Encoding::kCdr) {
    FieldReader<Encoding::kCdr> reader(bytes);
    fields(reader, message);
    return message;
  }
  if constexpr (kInRos1<Message>) {
    if (encoding == Encoding::kRos1) {
      FieldReader<Encoding::kRos1> reader(bytes);
      fields(reader, message);
      return message;
    }
  }
  throw DecodeError("byte 0: expected an encoding supported for this message");
}

template <typename Message>
void encode(const Message& message, Encoding encoding, std::vector<std::byte>& bytes) {
  if (encoding == Encoding::kCdr) {
    FieldWriter<Encoding::kCdr> writer(bytes);
    fields(writer, message);
    return;
  }
  if constexpr (kInRos1<Message>) {
    if (encoding == Encoding::kRos1) {
      FieldWriter<Encoding::kRos1> writer(bytes);
      fields(writer, message);
      return;
    }
  }
  throw std::invalid_argument("encode: expected an encoding supported for this message");
}

#define TOPOGEO_ROS_CODEC(Message)                                              \
  template Message decode<Message>(std::span<const std::byte> bytes, Encoding); \
  template void encode<Message>(const Message&, Encoding, std::vector<std::byte>&)

TOPOGEO_ROS_CODEC(ros::LaserScan);
TOPOGEO_ROS_CODEC(ros::Odometry);
TOPOGEO_ROS_CODEC(ros::TFMessage);
TOPOGEO_ROS_CODEC(ros::OccupancyGrid);
TOPOGEO_ROS_CODEC(ros::PoseStamped);
TOPOGEO_ROS_CODEC(ros::PoseWithCovarianceStamped);
TOPOGEO_ROS_CODEC(ros::TransformStamped);
TOPOGEO_ROS_CODEC(ros::MarkerArray);

#undef TOPOGEO_ROS_CODEC

}  // namespace topogeo::recording
