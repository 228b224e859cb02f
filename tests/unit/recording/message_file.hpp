// Writes recordings message by message, as drivers of all kinds make them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/messages.hpp"

#include "message_sink.hpp"

namespace topogeo::recording {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Messages are in the file in the order of the calls; `stamp_ns` is that of the header, `time_ns`
/// that of recording.
class MessageFile {
 public:
  explicit MessageFile(const std::filesystem::path& path) : sink_(create_sink(path, "none")) {}

  void scan(std::int64_t stamp_ns, std::int64_t time_ns, std::vector<float> ranges_m,
            const std::string& topic = "/scan", const std::string& frame = "laser") {
    ros::LaserScan scan;
    scan.header_(ros::header_of(frame, stamp_ns));
    scan.angle_min_(-0.75F);
    scan.angle_increment_(0.25F);
    scan.range_max_(30.0F);
    scan.ranges_(std::move(ranges_m));
    put(scan, topic, kLaserScanType, time_ns);
  }

  /// Writes a scan as a driver made it.
  void scan(const ros::LaserScan& scan, std::int64_t time_ns) {
    put(scan, "/scan", kLaserScanType, time_ns);
  }

  void odometry(std::int64_t stamp_ns, std::int64_t time_ns, const geometry::Pose2& T_odom_robot,
                const std::string& child = "base_link", const std::string& topic = "/odom",
                const std::string& frame = "odom") {
    ros::Odometry odometry;
    odometry.header_(ros::header_of(frame, stamp_ns));
    odometry.child_frame_id_(child);
    odometry.pose_().pose_(ros::pose_of(T_odom_robot));
    put(odometry, topic, kOdometryType, time_ns);
  }

  void transform(const std::string& parent, const std::string& child,
                 const geometry::Pose2& T_parent_child, std::int64_t stamp_ns,
                 const std::string& topic = "/tf_static") {
    ros::TFMessage message;
    message.transforms_() = {ros::transform_of(parent, child, T_parent_child, stamp_ns)};
    transforms(message, topic, stamp_ns);
  }

  void transforms(const ros::TFMessage& message, const std::string& topic, std::int64_t time_ns) {
    put(message, topic, kTfType, time_ns);
  }

  void close() { sink_->close(); }

 private:
  template <typename Message>
  void put(const Message& message, const std::string& topic, std::string_view type,
           std::int64_t time_ns) {
    bytes_.clear();
    encode(message, sink_->encoding(), bytes_);
    sink_->write({topic, type, time_ns, bytes_});
  }

  std::unique_ptr<MessageSink> sink_;
  std::vector<std::byte> bytes_;
};

/// A robot on an arc of 2 m radius at 0.5 m/s.
inline geometry::Pose2 arc_pose(double time_s) {
  const double turn = 0.25 * time_s;
  return {2.0 * std::sin(turn), 2.0 - 2.0 * std::cos(turn), turn};
}

/// Ranges that differ from those of other numbers.
inline std::vector<float> ranges_of(int number) {
  std::vector<float> ranges_m;
  ranges_m.reserve(7);
  for (int beam = 0; beam < 7; ++beam) {
    ranges_m.push_back(1.0F + 0.1F * static_cast<float>(beam) +
                       0.001F * static_cast<float>(number));
  }
  return ranges_m;
}

}  // namespace topogeo::recording
