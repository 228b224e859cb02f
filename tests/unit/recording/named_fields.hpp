// The fields of ROS messages by their ROS names, to fill them and to list their values.
#pragma once

#include <array>
#include <concepts>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::recording {

// NOLINTBEGIN(cppcoreguidelines-macro-usage): the name of a field is that of its accessor
#define TOPOGEO_FIELD(name) visit(#name, message.name##_())

void for_each_field(auto&& visit, ros::Time& message) {
  TOPOGEO_FIELD(sec);
  TOPOGEO_FIELD(nanosec);
}
void for_each_field(auto&& visit, ros::Duration& message) {
  TOPOGEO_FIELD(sec);
  TOPOGEO_FIELD(nanosec);
}
void for_each_field(auto&& visit, ros::Header& message) {
  TOPOGEO_FIELD(stamp);
  TOPOGEO_FIELD(frame_id);
}
void for_each_field(auto&& visit, ros::ColorRgba& message) {
  TOPOGEO_FIELD(r);
  TOPOGEO_FIELD(g);
  TOPOGEO_FIELD(b);
  TOPOGEO_FIELD(a);
}
void for_each_field(auto&& visit, ros::Point& message) {
  TOPOGEO_FIELD(x);
  TOPOGEO_FIELD(y);
  TOPOGEO_FIELD(z);
}
void for_each_field(auto&& visit, ros::Vector3& message) {
  TOPOGEO_FIELD(x);
  TOPOGEO_FIELD(y);
  TOPOGEO_FIELD(z);
}
void for_each_field(auto&& visit, ros::Quaternion& message) {
  TOPOGEO_FIELD(x);
  TOPOGEO_FIELD(y);
  TOPOGEO_FIELD(z);
  TOPOGEO_FIELD(w);
}
void for_each_field(auto&& visit, ros::Pose& message) {
  TOPOGEO_FIELD(position);
  TOPOGEO_FIELD(orientation);
}
void for_each_field(auto&& visit, ros::Transform& message) {
  TOPOGEO_FIELD(translation);
  TOPOGEO_FIELD(rotation);
}
void for_each_field(auto&& visit, ros::PoseStamped& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(pose);
}
void for_each_field(auto&& visit, ros::PoseWithCovariance& message) {
  TOPOGEO_FIELD(pose);
  TOPOGEO_FIELD(covariance);
}
void for_each_field(auto&& visit, ros::PoseWithCovarianceStamped& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(pose);
}
void for_each_field(auto&& visit, ros::Twist& message) {
  TOPOGEO_FIELD(linear);
  TOPOGEO_FIELD(angular);
}
void for_each_field(auto&& visit, ros::TwistStamped& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(twist);
}
void for_each_field(auto&& visit, ros::TwistWithCovariance& message) {
  TOPOGEO_FIELD(twist);
  TOPOGEO_FIELD(covariance);
}
void for_each_field(auto&& visit, ros::TransformStamped& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(child_frame_id);
  TOPOGEO_FIELD(transform);
}
void for_each_field(auto&& visit, ros::TFMessage& message) {
  TOPOGEO_FIELD(transforms);
}
void for_each_field(auto&& visit, ros::LaserScan& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(angle_min);
  TOPOGEO_FIELD(angle_max);
  TOPOGEO_FIELD(angle_increment);
  TOPOGEO_FIELD(time_increment);
  TOPOGEO_FIELD(scan_time);
  TOPOGEO_FIELD(range_min);
  TOPOGEO_FIELD(range_max);
  TOPOGEO_FIELD(ranges);
  TOPOGEO_FIELD(intensities);
}
void for_each_field(auto&& visit, ros::Odometry& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(child_frame_id);
  TOPOGEO_FIELD(pose);
  TOPOGEO_FIELD(twist);
}
void for_each_field(auto&& visit, ros::MapMetaData& message) {
  TOPOGEO_FIELD(map_load_time);
  TOPOGEO_FIELD(resolution);
  TOPOGEO_FIELD(width);
  TOPOGEO_FIELD(height);
  TOPOGEO_FIELD(origin);
}
void for_each_field(auto&& visit, ros::OccupancyGrid& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(info);
  TOPOGEO_FIELD(data);
}
void for_each_field(auto&& visit, ros::OccupancyGridUpdate& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(x);
  TOPOGEO_FIELD(y);
  TOPOGEO_FIELD(width);
  TOPOGEO_FIELD(height);
  TOPOGEO_FIELD(data);
}
void for_each_field(auto&& visit, ros::Path& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(poses);
}
void for_each_field(auto&& visit, ros::CompressedImage& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(format);
  TOPOGEO_FIELD(data);
}
void for_each_field(auto&& visit, ros::UvCoordinate& message) {
  TOPOGEO_FIELD(u);
  TOPOGEO_FIELD(v);
}
void for_each_field(auto&& visit, ros::MeshFile& message) {
  TOPOGEO_FIELD(filename);
  TOPOGEO_FIELD(data);
}
void for_each_field(auto&& visit, ros::Marker& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(ns);
  TOPOGEO_FIELD(id);
  TOPOGEO_FIELD(type);
  TOPOGEO_FIELD(action);
  TOPOGEO_FIELD(pose);
  TOPOGEO_FIELD(scale);
  TOPOGEO_FIELD(color);
  TOPOGEO_FIELD(lifetime);
  TOPOGEO_FIELD(frame_locked);
  TOPOGEO_FIELD(points);
  TOPOGEO_FIELD(colors);
  TOPOGEO_FIELD(texture_resource);
  TOPOGEO_FIELD(texture);
  TOPOGEO_FIELD(uv_coordinates);
  TOPOGEO_FIELD(text);
  TOPOGEO_FIELD(mesh_resource);
  TOPOGEO_FIELD(mesh_file);
  TOPOGEO_FIELD(mesh_use_embedded_materials);
}
void for_each_field(auto&& visit, ros::MarkerArray& message) {
  TOPOGEO_FIELD(markers);
}
void for_each_field(auto&& visit, diagnostic_msgs::msg::dds_::KeyValue_& message) {
  TOPOGEO_FIELD(key);
  TOPOGEO_FIELD(value);
}
void for_each_field(auto&& visit, ros::DiagnosticStatus& message) {
  TOPOGEO_FIELD(level);
  TOPOGEO_FIELD(name);
  TOPOGEO_FIELD(message);
  TOPOGEO_FIELD(hardware_id);
  TOPOGEO_FIELD(values);
}
void for_each_field(auto&& visit, ros::DiagnosticArray& message) {
  TOPOGEO_FIELD(header);
  TOPOGEO_FIELD(status);
}
void for_each_field(auto&& visit, ros::Clock& message) {
  TOPOGEO_FIELD(clock);
}

#undef TOPOGEO_FIELD
// NOLINTEND(cppcoreguidelines-macro-usage)

/// Gives each field a different value, exact in single precision; sequences get two elements.
class FieldFiller {
 public:
  template <typename Field>
  void operator()(const char* /*name*/, Field& field) {
    fill(field);
  }

 private:
  void fill(bool& field) { field = true; }
  template <std::integral Number>
  void fill(Number& field) {
    constexpr int kSmall = 100;  // that of int8
    field = static_cast<Number>(++last_ % kSmall);
  }
  template <std::floating_point Number>
  void fill(Number& field) {
    field = static_cast<Number>(++last_) + Number{0.25};
  }
  void fill(std::string& field) { field = "text " + std::to_string(++last_); }
  template <typename Element>
  void fill(std::vector<Element>& field) {
    field.resize(2);
    for (Element& element : field) fill(element);
  }
  template <typename Element, std::size_t size>
  void fill(std::array<Element, size>& field) {
    for (Element& element : field) fill(element);
  }
  template <typename Message>
  requires std::is_class_v<Message>
  void fill(Message& message) { for_each_field(*this, message); }

  int last_ = 0;
};

/// Contents of a message as JSON.
template <typename Field>
nlohmann::json json_of(Field& field) {
  if constexpr (!std::is_class_v<Field> || std::same_as<Field, std::string>) {
    return field;
  } else if constexpr (requires { field.begin(); }) {
    nlohmann::json array = nlohmann::json::array();
    for (auto& element : field) array.push_back(json_of(element));
    return array;
  } else {
    nlohmann::json object = nlohmann::json::object();
    for_each_field([&](const char* name, auto& inner) { object[name] = json_of(inner); }, field);
    return object;
  }
}

}  // namespace topogeo::recording
