#include "ros_scans.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"

#include "scan_units.hpp"

namespace topogeo::recording {
namespace {

using scan::SkipReason;

std::int64_t nanoseconds_of(double seconds) {
  return std::llround(seconds * 1e9);
}

std::string seconds_text_of(double seconds) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.3f s", seconds);
  return text;
}

}  // namespace

RosScans::RosScans(const std::filesystem::path& path, std::shared_ptr<const Drive> drive,
                   ros::SweepOrder sweep, const Correction& correction, Beams beams,
                   scan::ScanSequence::Skip skip)
    : drive_(std::move(drive)),
      sweep_(beams == Beams::kOnePattern ? sweep : ros::SweepOrder::kNone),
      correction_(correction),
      beams_(beams),
      skip_(std::move(skip)),
      source_(open_messages(
          path, [this](const Topic& topic) { return is_scan_topic(drive_->survey, topic); })) {
  const std::vector<std::string>& faults = drive_->timeline.faults();
  for (std::uint64_t i = 0; i < drive_->timeline.fault_count(); ++i) {
    skip_(SkipReason::kPose, 0, faults[std::min<std::size_t>(i, faults.size() - 1)]);
  }
}

std::optional<RosScans::Candidate> RosScans::next() {
  RawMessage message;
  while (!ended_) {
    if (source_->next(message)) {
      if (std::optional<Candidate> candidate = take(message)) return candidate;
      continue;
    }
    ended_ = true;
    if (!source_->damage().empty()) skip_(SkipReason::kTruncated, scans_, source_->damage());
  }
  return std::nullopt;
}

ros::Sweep RosScans::read_sweep(const RawMessage& message) const {
  const Survey& survey = drive_->survey;
  auto laser = decode<ros::LaserScan>(message.data, source_->topics()[message.topic].encoding);
  correct_degrees(laser);
  if (survey.ranges_in_millimetres) convert_millimetres(laser);
  const std::string frame = ros::frame_name(laser.header_().frame_id_());
  if (!is_of_laser(survey, frame)) {
    throw std::invalid_argument("frame_id: expected " + survey.laser_frame + ", got " + frame);
  }
  ros::Sweep sweep =
      ros::to_sweep(laser, survey.upside_down, scan::CarmenLogReader::kMaxBeams, sweep_);
  if (beams_ == Beams::kOnePattern && !ros::alike(sweep.pattern, *survey.beams)) {
    throw std::invalid_argument("expected " + text_of(*survey.beams) + " as in most scans, got " +
                                text_of(sweep.pattern));
  }
  return sweep;
}

std::optional<RosScans::Candidate> RosScans::take(const RawMessage& message) {
  const std::size_t number = scans_++;
  std::optional<std::int64_t> stamp_ns = drive_->timeline.scan_ns(number);
  if (stamp_ns) *stamp_ns -= correction_.delay_ns;
  try {
    ros::Sweep sweep = read_sweep(message);
    if (drive_->timeline.is_repeated(number)) return std::nullopt;
    if (!stamp_ns) {
      skip_(SkipReason::kStamp, scans_, "expected a time between those beside it, got another");
      return std::nullopt;
    }
    std::optional<ScreenedOdometry::Answer> pose;
    if (drive_->survey.odometry_topic.empty()) {
      pose.emplace();
    } else {
      pose = drive_->timeline.odometry().at(*stamp_ns);
    }
    if (!pose) {
      skip_without_pose(*stamp_ns);
      return std::nullopt;
    }
    // No echo has no place that a correction of motion could move.
    ros::limit_ranges(sweep.ranges_m, correction_.range_limit_m);
    for (float& range_m : sweep.ranges_m) range_m *= static_cast<float>(correction_.range_scale);
    if (is_repeated(sweep, *pose)) {
      skip_(SkipReason::kRepeated, scans_, std::string(scan::kRepeatedText));
      return std::nullopt;
    }
    Candidate candidate;
    candidate.place = scans_;
    candidate.scan.stamp_ns = *stamp_ns;
    candidate.scan.T_odom_robot = pose->T_odom_robot;
    candidate.scan.odometry_epoch = pose->epoch;
    put_beams(std::move(sweep), candidate.scan);
    return candidate;
  } catch (const DecodeError& error) {
    skip_(SkipReason::kFields, scans_, source_->position() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    skip_(SkipReason::kGeometry, scans_, error.what());
  }
  return std::nullopt;
}

void RosScans::skip_without_pose(std::int64_t stamp_ns) {
  const OdometryTrack::Gap gap = drive_->timeline.odometry().gap_at(stamp_ns);
  const auto seconds_to = [&](std::int64_t other_ns) {
    return seconds_text_of(std::fabs(static_cast<double>(other_ns - stamp_ns) * 1e-9));
  };
  if (!gap.before_ns && !gap.after_ns) {
    skip_(SkipReason::kNoOdometry, scans_, "expected odometry, got none");
  } else if (!gap.before_ns) {
    skip_(SkipReason::kOdometryEnds, scans_,
          "no odometry yet: the first comes " + seconds_to(*gap.after_ns) + " later");
  } else if (!gap.after_ns) {
    skip_(SkipReason::kOdometryEnds, scans_,
          "no odometry any more: the last came " + seconds_to(*gap.before_ns) + " before");
  } else {
    char text[120];
    std::snprintf(text, sizeof(text), " with a step of %.2f m and %.2f rad", gap.step_m,
                  gap.turn_rad);
    skip_(SkipReason::kNoOdometry, scans_,
          "expected odometry around the time of the scan, got a gap of " +
              seconds_text_of(static_cast<double>(*gap.after_ns - *gap.before_ns) * 1e-9) + text);
  }
}

// A check of the log counts such scans by itself.
bool RosScans::is_repeated(const ros::Sweep& sweep, const ScreenedOdometry::Answer& pose) {
  return beams_ == Beams::kOnePattern &&
         repeated_.add(sweep.ranges_m, pose.T_odom_robot, pose.epoch);
}

void RosScans::put_beams(ros::Sweep sweep, scan::Scan& scan) const {
  const Survey& survey = drive_->survey;
  if (beams_ == Beams::kOnePattern) {
    // An unknown mounting is assumed at the robot's centre.
    const geometry::Pose2 T_robot_laser =
        survey.mounting ? survey.mounting->T_robot_laser : geometry::Pose2{};
    if (survey.odometry_topic.empty()) {
      // Odometry from the scans knows the motion, too.
      scan.first_beam_s = sweep.first_beam_s;
      scan.beam_step_s = sweep.time_step_s;
    } else if (sweep.time_step_s != 0.0) {
      sweep.ranges_m = ros::deskewed(sweep, [&](double after_s) -> std::optional<geometry::Pose2> {
        const auto odometry =
            drive_->timeline.odometry().at(scan.stamp_ns + nanoseconds_of(after_s));
        if (!odometry || odometry->epoch != scan.odometry_epoch) return std::nullopt;
        return odometry->T_odom_robot * T_robot_laser;
      });
    }
    if (!ros::same_beams(sweep.pattern, *survey.beams)) {
      sweep.ranges_m = ros::on_pattern(sweep, *survey.beams);
      scan.first_beam_s = scan.beam_step_s = 0.0;  // of other beams
    }
    sweep.pattern = *survey.beams;
  }
  ros::limit_ranges(sweep.ranges_m, correction_.range_limit_m * correction_.range_scale);
  scan.angle_min_rad = sweep.pattern.angle_min_rad;
  scan.angle_step_rad = sweep.pattern.angle_step_rad;
  scan.ranges_m = std::move(sweep.ranges_m);
}

}  // namespace topogeo::recording
