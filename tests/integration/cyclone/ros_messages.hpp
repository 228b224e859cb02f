// Headers, stamps and headings of ROS messages in Cyclone's C.
#pragma once

#include <cmath>
#include <cstdint>

#include "geometry_msgs.h"
#include "std_msgs.h"

namespace topogeo::test {

using Header = std_msgs_msg_dds__Header_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using PoseMessage = geometry_msgs_msg_dds__PoseWithCovarianceStamped_;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kStart_ns = 1'700'000'000 * kSecond_ns;

// Cyclone's strings are not const.
inline char kOdom[] = "odom";
inline char kBase[] = "base_link";
inline char kLaser[] = "laser";
inline char kMap[] = "map";

inline Header header(char* frame, std::int64_t stamp_ns) {
  Header out{};
  out.stamp_.sec_ = static_cast<std::int32_t>(stamp_ns / kSecond_ns);
  out.stamp_.nanosec_ = static_cast<std::uint32_t>(stamp_ns % kSecond_ns);
  out.frame_id_ = frame;
  return out;
}

inline std::int64_t stamp_ns(const Header& of) {
  return of.stamp_.sec_ * kSecond_ns + of.stamp_.nanosec_;
}

inline double yaw(const geometry_msgs_msg_dds__Quaternion_& q) {
  return std::atan2(2.0 * (q.w_ * q.z_ + q.x_ * q.y_), 1.0 - 2.0 * (q.y_ * q.y_ + q.z_ * q.z_));
}

inline geometry_msgs_msg_dds__Quaternion_ quaternion(double yaw_rad) {
  geometry_msgs_msg_dds__Quaternion_ q{};
  q.z_ = std::sin(yaw_rad / 2.0);
  q.w_ = std::cos(yaw_rad / 2.0);
  return q;
}

}  // namespace topogeo::test
