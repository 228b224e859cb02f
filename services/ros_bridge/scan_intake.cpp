#include "scan_intake.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "topogeo/geometry/odometry_screen.hpp"
#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr std::int64_t kTimeJump_ns = 1'000'000'000;
/// Same tolerance as for a log that contradicts the configuration.
constexpr double kMountingTolerance_m = 0.02;

std::string text(const geometry::Pose2& pose) {
  return std::to_string(pose.x_m) + "," + std::to_string(pose.y_m) + "," +
         std::to_string(pose.theta_rad);
}

}  // namespace

std::string_view describe(IntakeDrop drop) {
  switch (drop) {
    case IntakeDrop::kInvalidScan:
      return "invalid ROS scan";
    case IntakeDrop::kOtherFrame:
      return "scan of another frame";
    case IntakeDrop::kNoOdometry:
      return "no odometry";
    case IntakeDrop::kNoMounting:
      return "unknown frame of the laser";
    case IntakeDrop::kTilted:
      return "tilted laser";
    case IntakeDrop::kOtherMounting:
      return "laser mounted elsewhere";
    case IntakeDrop::kOldScan:
      return "time not increasing";
    case IntakeDrop::kOtherBeams:
      return "scan of other beams";
    case IntakeDrop::kInvalidOdometry:
      return "invalid ROS odometry";
    case IntakeDrop::kOldOdometry:
      return "odometry not newer";
  }
  return "unknown";
}

void ScanIntake::begin() {
  track_ = geometry::OdometryTrack(options_.longest_extrapolation_ns);
  last_odometry_.reset();
  waiting_.clear();
  last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  next_sequence_ = 0;
  ++epochs_;
}

void ScanIntake::count(IntakeDrop drop, const std::string& detail) {
  ++drops_[static_cast<std::size_t>(drop)];
  details_[static_cast<std::size_t>(drop)] = detail;
}

std::string ScanIntake::add(const geometry::OdometrySample& sample) {
  std::string why;
  if (last_odometry_) {
    const std::int64_t passed_ns = sample.stamp_ns - last_odometry_->stamp_ns;
    if (passed_ns < -kTimeJump_ns) {
      why = "time went back by " + std::to_string(static_cast<double>(-passed_ns) * 1e-9) + " s";
    } else if (passed_ns <= 0) {
      count(IntakeDrop::kOldOdometry, std::to_string(sample.stamp_ns));
      return {};
    } else if (!geometry::is_possible_step(*last_odometry_, sample)) {
      const geometry::Pose2 step =
          geometry::between(last_odometry_->T_odom_robot, sample.T_odom_robot);
      why = "the odometry jumped by " + std::to_string(step.position_m().norm()) + " m and " +
            std::to_string(step.theta_rad) + " rad";
    }
  }
  if (!why.empty()) begin();
  last_odometry_ = sample;
  static_cast<void>(track_.add(sample));
  return why;
}

void ScanIntake::add(const ros::LaserScan& message, std::int64_t arrival_ns) {
  waiting_.push_back({message, arrival_ns});
}

std::vector<ScanIntake::Leaving> ScanIntake::take(std::int64_t now_ns) {
  std::vector<Leaving> scans;
  while (!waiting_.empty()) {
    const Waiting& first = waiting_.front();
    const std::int64_t stamp_ns = ros::stamp_ns_of(first.message.header_().stamp_());
    const bool bracketed =
        options_.without_odometry || (track_.last_ns() && *track_.last_ns() >= stamp_ns);
    if (!bracketed && now_ns < due_ns()) break;
    if (auto scan = finish(first.message)) scans.push_back({*std::move(scan), first.arrival_ns});
    waiting_.pop_front();
  }
  return scans;
}

std::int64_t ScanIntake::due_ns() const {
  return waiting_.empty() ? std::numeric_limits<std::int64_t>::max()
                          : waiting_.front().arrival_ns + options_.odometry_wait_ns;
}

bool ScanIntake::find_mounting(const std::string& laser_frame) {
  if (!options_.mounting_from_tf || (options_.without_odometry && robot_frame_.empty())) {
    mounting_ = ros::LaserMounting{options_.T_robot_laser};
    return true;
  }
  const auto T_robot_laser = frames_.find(robot_frame_, laser_frame);
  if (!T_robot_laser) {
    count(IntakeDrop::kNoMounting, "no transform from " + robot_frame_ + " to " + laser_frame);
    return false;
  }
  const ros::LaserMounting mounting = ros::planar_mounting(*T_robot_laser);
  if (mounting.tilt_rad > ros::kLargestTilt_rad) {
    count(IntakeDrop::kTilted,
          laser_frame + " does not scan parallel to the floor of " + robot_frame_);
    return false;
  }
  mounting_ = mounting;
  const Eigen::Vector2d apart_m =
      mounting.T_robot_laser.position_m() - options_.T_robot_laser.position_m();
  if (!(apart_m.norm() <= kMountingTolerance_m)) {
    count(IntakeDrop::kOtherMounting,
          "/tf_static has it at " + text(mounting.T_robot_laser) + ", the configuration at " +
              text(options_.T_robot_laser) +
              ": start the services with --laser=" + text(mounting.T_robot_laser));
    return false;
  }
  return true;
}

std::optional<scan::Scan> ScanIntake::finish(const ros::LaserScan& message) {
  const std::string frame = ros::frame_name(message.header_().frame_id_());
  if (laser_frame_ && *laser_frame_ != frame) {
    count(IntakeDrop::kOtherFrame, frame + ", the first was of " + *laser_frame_);
    return std::nullopt;
  }
  if (!find_mounting(frame)) return std::nullopt;
  try {
    const ros::Sweep sweep =
        ros::to_sweep(message, mounting_->upside_down, options_.most_beams, options_.sweep);
    auto scan = finish(sweep, ros::stamp_ns_of(message.header_().stamp_()));
    if (scan) laser_frame_ = frame;
    return scan;
  } catch (const std::invalid_argument& error) {
    count(IntakeDrop::kInvalidScan, error.what());
    return std::nullopt;
  }
}

void ScanIntake::follow_clock(std::int64_t stamp_ns) {
  if (!options_.without_odometry || next_sequence_ == 0 ||
      stamp_ns >= last_stamp_ns_ - kTimeJump_ns) {
    return;
  }
  last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  next_sequence_ = 0;
  ++epochs_;
}

std::optional<scan::Scan> ScanIntake::finish(const ros::Sweep& sweep, std::int64_t stamp_ns) {
  follow_clock(stamp_ns);
  if (stamp_ns <= last_stamp_ns_) {
    count(IntakeDrop::kOldScan, std::to_string(stamp_ns));
    return std::nullopt;
  }
  const auto odometry = track_.at(stamp_ns);
  if (!odometry && !options_.without_odometry) {
    count(IntakeDrop::kNoOdometry, "at the time " + std::to_string(stamp_ns));
    return std::nullopt;
  }
  if (!pattern_) pattern_ = sweep.pattern;
  if (!ros::alike(sweep.pattern, *pattern_)) {
    count(IntakeDrop::kOtherBeams,
          text_of(sweep.pattern) + ", the first scan had " + text_of(*pattern_));
    return std::nullopt;
  }
  scan::Scan scan;
  if (odometry) scan.T_odom_robot = odometry->T_odom_robot;
  scan.ranges_m = ranges_of(sweep, stamp_ns, scan.T_odom_robot);
  scan.stamp_ns = stamp_ns;
  if (options_.without_odometry && ros::same_beams(sweep.pattern, *pattern_)) {
    scan.first_beam_s = sweep.first_beam_s;
    scan.beam_step_s = sweep.time_step_s;
  }
  scan.sequence = next_sequence_++;
  scan.odometry_epoch = epochs_;
  // The configured laser frame may be rotated against that of /tf: only the positions must agree.
  const double turn_rad =
      geometry::wrap_angle(mounting_->T_robot_laser.theta_rad - options_.T_robot_laser.theta_rad);
  scan.angle_min_rad = pattern_->angle_min_rad + turn_rad;
  scan.angle_step_rad = pattern_->angle_step_rad;
  last_stamp_ns_ = stamp_ns;
  return scan;
}

std::vector<float> ScanIntake::ranges_of(const ros::Sweep& sweep, std::int64_t stamp_ns,
                                         const geometry::Pose2& T_odom_robot) {
  ros::Sweep straight = sweep;
  ros::limit_ranges(straight.ranges_m, options_.range_limit_m);
  if (options_.detect_no_return) no_return_.add(straight.ranges_m, T_odom_robot);
  if (no_return_.found()) ros::limit_ranges(straight.ranges_m, no_return_.found()->least_m);
  if (sweep.time_step_s != 0.0 && !options_.without_odometry) {
    straight.ranges_m =
        ros::deskewed(straight, [&](double after_s) -> std::optional<geometry::Pose2> {
          const auto odometry = track_.at(stamp_ns + std::llround(after_s * 1e9));
          if (!odometry) return std::nullopt;
          return odometry->T_odom_robot * mounting_->T_robot_laser;
        });
  }
  if (!ros::same_beams(sweep.pattern, *pattern_)) {
    ++adapted_;
    straight.ranges_m = ros::on_pattern(straight, *pattern_);
  }
  ros::limit_ranges(straight.ranges_m, options_.range_limit_m);
  return std::move(straight.ranges_m);
}

}  // namespace topogeo::ros_bridge
