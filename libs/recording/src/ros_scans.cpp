#include "ros_scans.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"

namespace topogeo::recording {
namespace {

using scan::SkipReason;

/// Most scans that wait for odometry: minutes of a recording whose topics were written one after
/// the other.
constexpr std::size_t kMostWaiting = 4096;
/// Same limit as for CARMEN logs: a farther pose is no odometry.
constexpr double kFarthest_m = 1e6;
constexpr std::int64_t kLastStamp_ns = 9'000'000'000'000'000'000;

/// The stamp of the header or, if it has none, of the recording.
std::int64_t stamp_of(const ros::Header& header, std::int64_t log_time_ns) {
  const std::int64_t stamp_ns = ros::stamp_ns_of(header.stamp_());
  return stamp_ns != 0 ? stamp_ns : log_time_ns;
}

bool is_usable(std::int64_t stamp_ns) {
  return stamp_ns >= 0 && stamp_ns <= kLastStamp_ns;
}

std::int64_t nanoseconds_of(double seconds) {
  return std::llround(seconds * 1e9);
}

std::string seconds_text_of(double seconds) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.3f s", seconds);
  return text;
}

}  // namespace

RosScans::RosScans(const std::filesystem::path& path, const TopicChoice& choice,
                   double range_limit_m, Beams beams, scan::ScanSequence::Skip skip)
    : survey_(survey(path, choice)),
      sweep_(beams == Beams::kOnePattern ? choice.sweep : ros::SweepOrder::kNone),
      range_limit_m_(range_limit_m),
      beams_(beams),
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
  if (waiting_.empty()) return false;
  const Waiting& front = waiting_.front();
  const std::int64_t last_beam_ns =
      front.stamp_ns + nanoseconds_of(std::max(0.0, front.sweep.farthest_s()));
  return ended_ || waiting_.size() > kMostWaiting || track_.reaches(last_beam_ns);
}

std::optional<RosScans::Candidate> RosScans::take_front() {
  const Waiting front = std::move(waiting_.front());
  waiting_.pop_front();
  const std::optional<ScreenedOdometry::Answer> pose = track_.at(front.stamp_ns);
  if (!pose) {
    const std::optional<double> distance_s = track_.distance_s(front.stamp_ns);
    skip_(SkipReason::kPose, front.place,
          "expected odometry around the time of the scan, got " +
              (distance_s ? "the nearest " + seconds_text_of(*distance_s) + " off"
                          : std::string("none")));
    return std::nullopt;
  }
  Candidate candidate;
  candidate.place = front.place;
  candidate.scan.stamp_ns = front.stamp_ns;
  candidate.scan.T_odom_robot = pose->T_odom_robot;
  candidate.scan.odometry_epoch = pose->epoch;
  put_beams(front, candidate.scan);
  track_.forget_before(front.stamp_ns + nanoseconds_of(std::min(0.0, front.sweep.farthest_s())));
  return candidate;
}

void RosScans::put_beams(const Waiting& from, scan::Scan& scan) const {
  ros::Sweep sweep = from.sweep;
  // No echo has no place that a correction of motion could move.
  ros::limit_ranges(sweep.ranges_m, range_limit_m_);
  if (beams_ == Beams::kOnePattern) {
    // An unknown mounting is assumed at the robot's centre.
    const geometry::Pose2 T_robot_laser =
        survey_.mounting ? survey_.mounting->T_robot_laser : geometry::Pose2{};
    if (sweep.time_step_s != 0.0) {
      sweep.ranges_m = ros::deskewed(sweep, [&](double after_s) -> std::optional<geometry::Pose2> {
        const auto odometry = track_.at(from.stamp_ns + nanoseconds_of(after_s));
        if (!odometry || odometry->epoch != scan.odometry_epoch) return std::nullopt;
        return odometry->T_odom_robot * T_robot_laser;
      });
    }
    if (!ros::same_beams(sweep.pattern, *survey_.beams)) {
      sweep.ranges_m = ros::on_pattern(sweep, *survey_.beams);
    }
    sweep.pattern = *survey_.beams;
  }
  ros::limit_ranges(sweep.ranges_m, range_limit_m_);
  scan.angle_min_rad = sweep.pattern.angle_min_rad;
  scan.angle_step_rad = sweep.pattern.angle_step_rad;
  scan.ranges_m = std::move(sweep.ranges_m);
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
    const std::string frame = ros::frame_name(laser.header_().frame_id_());
    if (frame != survey_.laser_frame && !survey_.laser_frame.empty()) {
      throw std::invalid_argument("frame_id: expected " + survey_.laser_frame + ", got " + frame);
    }
    Waiting scan{scans_, stamp_of(laser.header_(), message.log_time_ns),
                 ros::to_sweep(laser, survey_.mounting && survey_.mounting->upside_down,
                               scan::CarmenLogReader::kMaxBeams, sweep_)};
    if (beams_ == Beams::kOnePattern && !ros::alike(scan.sweep.pattern, *survey_.beams)) {
      throw std::invalid_argument("expected " + text_of(*survey_.beams) +
                                  " as in most scans, got " + text_of(scan.sweep.pattern));
    }
    if (!is_usable(scan.stamp_ns)) {
      skip_(SkipReason::kStamp, scans_, "expected a time since 1970, got another");
      return;
    }
    waiting_.push_back(std::move(scan));
  } catch (const DecodeError& error) {
    skip_(SkipReason::kFields, scans_, source_->position() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    skip_(SkipReason::kGeometry, scans_, error.what());
  }
}

void RosScans::take_odometry(const RawMessage& message, const Topic& topic) {
  try {
    const auto odometry = decode<ros::Odometry>(message.data, topic.encoding);
    if (ros::frame_name(odometry.header_().frame_id_()) != survey_.odom_frame ||
        ros::frame_name(odometry.child_frame_id_()) != survey_.odometry_child_frame) {
      return;  // of another robot, as the survey says
    }
    ++odometry_;
    add_pose(odometry.header_(), message.log_time_ns, ros::planar(odometry.pose_().pose_()));
  } catch (const DecodeError& error) {
    skip_(SkipReason::kPose, scans_, source_->position() + ": " + error.what());
  }
}

void RosScans::take_transforms(const RawMessage& message, const Topic& topic) {
  try {
    const auto transforms = decode<ros::TFMessage>(message.data, topic.encoding);
    for (const ros::TransformStamped& stated : transforms.transforms_()) {
      if (ros::frame_name(stated.header_().frame_id_()) != survey_.odom_frame ||
          ros::frame_name(stated.child_frame_id_()) != survey_.odometry_child_frame) {
        continue;
      }
      ++odometry_;
      add_pose(stated.header_(), message.log_time_ns, ros::planar(stated.transform_()));
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
  track_.finish();
  if (!source_->damage().empty()) skip_(SkipReason::kTruncated, scans_, source_->damage());
}

}  // namespace topogeo::recording
