#include "ros_scans.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace topogeo::recording {
namespace {

using scan::SkipReason;

/// Scans that wait for odometry, at most: minutes of a recording whose topics were written one
/// after the other.
constexpr std::size_t kMostWaiting = 4096;
/// As CARMEN logs are read: farther off is no odometry.
constexpr double kFarthest_m = 1e6;
constexpr std::int64_t kLastStamp_ns = 9'000'000'000'000'000'000;

/// That of the header, or where it has none, that of the recording.
std::int64_t stamp_of(const ros::Header& header, std::int64_t log_time_ns) {
  const std::int64_t stamp_ns = to_stamp_ns(header.stamp_());
  return stamp_ns != 0 ? stamp_ns : log_time_ns;
}

bool is_usable(std::int64_t stamp_ns) {
  return stamp_ns >= 0 && stamp_ns <= kLastStamp_ns;
}

std::string seconds_text_of(double seconds) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.3f s", seconds);
  return text;
}

}  // namespace

RosScans::RosScans(const std::filesystem::path& path, const TopicChoice& choice,
                   double range_limit_m, scan::ScanSequence::Skip skip)
    : survey_(survey(path, choice)),
      range_limit_m_(range_limit_m),
      skip_(std::move(skip)),
      source_(open_messages(path, [this](const Topic& topic) {
        if (topic.encoding == Encoding::kOther) return false;
        return (topic.name == survey_.scan_topic && topic.type == kLaserScanType) ||
               (topic.name == survey_.odometry_topic &&
                topic.type == (survey_.odometry_from_tf ? kTfType : kOdometryType));
      })) {}

std::optional<RosScans::Candidate> RosScans::next() {
  while (true) {
    while (front_is_due()) {
      if (std::optional<Candidate> candidate = take_front()) return candidate;
    }
    if (ended_) return std::nullopt;
    RawMessage message;
    if (source_->next(message)) {
      take(message);
    } else {
      finish();
    }
  }
}

bool RosScans::front_is_due() const {
  return !waiting_.empty() && (ended_ || waiting_.size() > kMostWaiting ||
                               track_.reaches(waiting_.front().scan.stamp_ns));
}

std::optional<RosScans::Candidate> RosScans::take_front() {
  Candidate candidate = std::move(waiting_.front());
  waiting_.pop_front();
  const std::int64_t stamp_ns = candidate.scan.stamp_ns;
  const std::optional<geometry::Pose2> pose = track_.at(stamp_ns);
  if (!pose) {
    const std::optional<double> distance_s = track_.distance_s(stamp_ns);
    skip_(SkipReason::kPose, candidate.place,
          "expected odometry around the time of the scan, got " +
              (distance_s ? "the nearest " + seconds_text_of(*distance_s) + " off"
                          : std::string("none")));
    return std::nullopt;
  }
  track_.forget_before(stamp_ns);
  candidate.scan.T_odom_robot = *pose;
  return candidate;
}

void RosScans::take(const RawMessage& message) {
  ++messages_;
  const Topic& topic = source_->topics()[message.topic];
  if (topic.type == kLaserScanType) {
    take_scan(message, topic);
  } else if (topic.type == kOdometryType) {
    take_odometry(message, topic);
  } else {
    take_transforms(message, topic);
  }
}

void RosScans::take_scan(const RawMessage& message, const Topic& topic) {
  ++scans_;
  try {
    const auto laser = decode<ros::LaserScan>(message.data, topic.encoding);
    Candidate candidate;
    candidate.place = scans_;
    candidate.scan =
        to_scan(laser, survey_.mounting && survey_.mounting->upside_down, range_limit_m_);
    candidate.scan.stamp_ns = stamp_of(laser.header_(), message.log_time_ns);
    if (!is_usable(candidate.scan.stamp_ns)) {
      skip_(SkipReason::kStamp, scans_, "expected a time since 1970, got another");
      return;
    }
    waiting_.push_back(std::move(candidate));
  } catch (const DecodeError& error) {
    skip_(SkipReason::kFields, scans_, source_->position() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    skip_(SkipReason::kGeometry, scans_, error.what());
  }
}

void RosScans::take_odometry(const RawMessage& message, const Topic& topic) {
  ++odometry_;
  try {
    const auto odometry = decode<ros::Odometry>(message.data, topic.encoding);
    add_pose(odometry.header_(), message.log_time_ns, planar_pose(odometry.pose_().pose_()));
  } catch (const DecodeError& error) {
    skip_(SkipReason::kPose, scans_, source_->position() + ": " + error.what());
  }
}

void RosScans::take_transforms(const RawMessage& message, const Topic& topic) {
  try {
    const auto transforms = decode<ros::TfMessage>(message.data, topic.encoding);
    for (const ros::TransformStamped& stated : transforms.transforms_()) {
      if (frame_name(stated.header_().frame_id_()) != survey_.odom_frame ||
          frame_name(stated.child_frame_id_()) != survey_.robot_frame) {
        continue;
      }
      ++odometry_;
      add_pose(stated.header_(), message.log_time_ns, planar_pose(stated.transform_()));
    }
  } catch (const DecodeError& error) {
    skip_(SkipReason::kPose, scans_, source_->position() + ": " + error.what());
  }
}

void RosScans::add_pose(const ros::Header& header, std::int64_t log_time_ns,
                        const std::optional<geometry::Pose2>& T_odom_robot) {
  const std::int64_t stamp_ns = stamp_of(header, log_time_ns);
  if (!T_odom_robot || !is_usable(stamp_ns) || std::fabs(T_odom_robot->x_m) > kFarthest_m ||
      std::fabs(T_odom_robot->y_m) > kFarthest_m) {
    skip_(SkipReason::kPose, scans_,
          source_->position() + ": expected an odometry pose within 1e6 m, got another");
    return;
  }
  track_.add(stamp_ns, *T_odom_robot);
}

void RosScans::finish() {
  ended_ = true;
  if (!source_->damage().empty()) skip_(SkipReason::kTruncated, scans_, source_->damage());
}

}  // namespace topogeo::recording
