#include "timeline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/messages.hpp"

#include "odometry_message.hpp"

namespace topogeo::recording {
namespace {

/// Same limit as for CARMEN logs: a farther pose is no odometry.
constexpr double kFarthest_m = 1e6;

std::uint64_t content_of(std::span<const std::byte> data) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(data.data()), data.size()});
}

std::uint64_t content_of(const geometry::Pose2& pose) {
  const std::array<double, 3> numbers = {pose.x_m, pose.y_m, pose.theta_rad};
  return content_of(std::as_bytes(std::span(numbers)));
}

StampedMessage stamped(const ros::Header& header, std::int64_t log_time_ns, std::uint64_t content) {
  const auto within = [](std::int64_t time_ns) {
    return std::clamp<std::int64_t>(time_ns, 0, StampedMessage::kLatest_ns);
  };
  return {within(ros::stamp_ns_of(header.stamp_())), within(log_time_ns), content};
}

}  // namespace

bool is_scan_topic(const Survey& survey, const Topic& topic) {
  return topic.encoding != Encoding::kOther && topic.type == kLaserScanType &&
         topic.name == survey.scan_topic;
}

bool is_odometry_topic(const Survey& survey, const Topic& topic) {
  return topic.encoding != Encoding::kOther && topic.name == survey.odometry_topic &&
         topic.type == survey.odometry_type;
}

bool is_of_laser(const Survey& survey, const std::string& frame) {
  return survey.laser_frame.empty() || frame == survey.laser_frame;
}

struct Timeline::Collected {
  std::vector<StampedMessage> scans;
  std::vector<std::size_t> scan_numbers;  // of each of `scans` among all of the topic
  std::size_t scan_messages = 0;
  std::vector<StampedMessage> odometry;
  std::vector<geometry::Pose2> poses;
};

Timeline::Timeline(const std::filesystem::path& path, const Survey& survey) : survey_(survey) {
  source_ = open_messages(path, [this](const Topic& topic) {
    return is_scan_topic(survey_, topic) || is_odometry_topic(survey_, topic);
  });
  Collected collected;
  RawMessage message;
  while (source_->next(message)) {
    const Topic& topic = source_->topics()[message.topic];
    if (topic.type == kLaserScanType) {
      take_scan(message, topic, collected);
    } else if (states_pose(topic.type)) {
      take_odometry(message, topic, collected);
    } else {
      take_transforms(message, topic, collected);
    }
  }
  source_.reset();
  finish(collected);
}

void Timeline::take_scan(const RawMessage& message, const Topic& topic, Collected& collected) {
  const std::size_t number = collected.scan_messages++;
  try {
    const auto scan = decode<ros::LaserScan>(message.data, topic.encoding);
    if (!is_of_laser(survey_, ros::frame_name(scan.header_().frame_id_()))) return;
    collected.scans.push_back(
        stamped(scan.header_(), message.log_time_ns, content_of(message.data)));
    collected.scan_numbers.push_back(number);
  } catch (const DecodeError&) {  // NOLINT(bugprone-empty-catch): RosScans reports it
  }
}

void Timeline::take_odometry(const RawMessage& message, const Topic& topic, Collected& collected) {
  try {
    const OdometryMessage odometry = decode_odometry(topic.type, message.data, topic.encoding);
    if (ros::frame_name(odometry.header.frame_id_()) != survey_.odom_frame ||
        odometry.child_frame != survey_.odometry_child_frame) {
      return;  // of another robot, as the survey says
    }
    ++odometry_messages_;
    add_pose(odometry.header, message.log_time_ns, odometry.T_odom_robot, collected);
  } catch (const DecodeError& error) {
    ++odometry_messages_;
    found_fault(error.what());
  }
}

void Timeline::take_transforms(const RawMessage& message, const Topic& topic,
                               Collected& collected) {
  try {
    const auto transforms = decode<ros::TFMessage>(message.data, topic.encoding);
    for (const ros::TransformStamped& stated : transforms.transforms_()) {
      if (ros::frame_name(stated.header_().frame_id_()) != survey_.odom_frame ||
          ros::frame_name(stated.child_frame_id_()) != survey_.odometry_child_frame) {
        continue;
      }
      ++odometry_messages_;
      add_pose(stated.header_(), message.log_time_ns, ros::planar(stated.transform_()), collected);
    }
  } catch (const DecodeError& error) {
    found_fault(error.what());
  }
}

void Timeline::add_pose(const ros::Header& header, std::int64_t log_time_ns,
                        const std::optional<geometry::Pose2>& T_odom_robot, Collected& collected) {
  if (!T_odom_robot || std::fabs(T_odom_robot->x_m) > kFarthest_m ||
      std::fabs(T_odom_robot->y_m) > kFarthest_m) {
    found_fault("expected an odometry pose within 1e6 m, got another");
    return;
  }
  collected.odometry.push_back(stamped(header, log_time_ns, content_of(*T_odom_robot)));
  collected.poses.push_back(*T_odom_robot);
}

void Timeline::found_fault(const std::string& text) {
  constexpr std::size_t kMostTexts = 100;
  ++fault_count_;
  if (faults_.size() < kMostTexts) faults_.push_back(source_->position() + ": " + text);
}

void Timeline::finish(const Collected& collected) {
  RepairedStamps repaired = repair_stamps(collected.scans, collected.odometry);
  notes_ = std::move(repaired.notes);
  scans_ns_.resize(collected.scan_messages);
  scans_repeated_.resize(collected.scan_messages);
  for (std::size_t i = 0; i < collected.scans.size(); ++i) {
    scans_ns_[collected.scan_numbers[i]] = repaired.scans_ns[i];
    scans_repeated_[collected.scan_numbers[i]] = repaired.scans_repeated[i];
  }
  std::vector<std::pair<std::int64_t, std::size_t>> in_order;
  for (std::size_t i = 0; i < collected.poses.size(); ++i) {
    if (repaired.odometry_ns[i]) in_order.emplace_back(*repaired.odometry_ns[i], i);
  }
  std::ranges::sort(in_order);
  for (const auto& [stamp_ns, number] : in_order) {
    odometry_.add(stamp_ns, collected.poses[number]);
  }
  odometry_.finish();
}

std::optional<std::int64_t> Timeline::scan_ns(std::size_t number) const {
  return number < scans_ns_.size() ? scans_ns_[number] : std::nullopt;
}

bool Timeline::is_repeated(std::size_t number) const {
  return number < scans_repeated_.size() && scans_repeated_[number];
}

std::vector<std::string> Timeline::notes() const {
  std::vector<std::string> notes = notes_;
  for (std::string& note : odometry_.notes()) notes.push_back(std::move(note));
  return notes;
}

}  // namespace topogeo::recording
