#include "topogeo/matching/laser_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "topogeo/scan/deskew.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

#include "laser_track.hpp"
#include "match_evidence.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// The second track takes over once it is longer than the time for which something covers a laser
// in passing, and has enough scans to make a place.
constexpr std::int64_t kLost_ns = 2'000'000'000;
constexpr std::size_t kLostScans = 5;
// Between bare walls for longer, a laser may have changed its speed
// (docs/decisions/laser_odometry.md).
constexpr double kMostUnseen_m = 3.4;

}  // namespace

LaserOdometry::LaserOdometry(const Pose2& T_robot_laser, double points_range_m)
    : T_robot_laser_(T_robot_laser), points_range_m_(points_range_m) {}

LaserOdometry::LaserOdometry(LaserOdometry&&) noexcept = default;
LaserOdometry& LaserOdometry::operator=(LaserOdometry&&) noexcept = default;
LaserOdometry::~LaserOdometry() = default;

const LaserTrack* LaserOdometry::moving_track() const {
  if (second_) return second_.get();
  return track_.get();
}

void LaserOdometry::take_out_motion(scan::Scan& scan) const {
  const LaserTrack* track = moving_track();
  if (scan.beam_step_s != 0.0 && track != nullptr) {
    const Eigen::Vector3d velocity = track->velocity();
    scan.ranges_m = scan::deskewed(
        {{scan.angle_min_rad, scan.angle_step_rad, scan.ranges_m.size()},
         scan.ranges_m,
         scan.first_beam_s,
         scan.beam_step_s},
        [&](double after_s) {
          const Eigen::Vector3d moved = after_s * velocity;
          const Pose2 half_turn{0.0, 0.0, 0.5 * moved.z()};
          return half_turn * Pose2{moved.x(), moved.y(), 0.0} * half_turn * T_robot_laser_;
        });
  }
  scan.first_beam_s = scan.beam_step_s = 0.0;
}

void LaserOdometry::add(scan::Scan scan) {
  ++counts_.scans;
  newest_ns_ = scan.stamp_ns;
  take_out_motion(scan);
  const auto points = topomap::scan_points(scan, T_robot_laser_, points_range_m_);
  const TimedFeatures seen{scan.stamp_ns, std::make_shared<const MatchFeatures>(
                                              extract_scan_features(points, T_robot_laser_))};
  if (!track_) {
    begin(std::move(scan), seen);
    return;
  }
  if (!second_) {
    if (const std::optional<LaserStep> step = track_->add(seen)) {
      counts_.unplaced += waiting_.size();
      waiting_.clear();
      follow_first(std::move(scan), seen, *step);
      return;
    }
    if (!place_held()) {
      begin_anew();
      begin(std::move(scan), seen);
      return;
    }
  }
  follow_second(std::move(scan), seen);
  if (find_again(seen)) {
    place_waiting(T_odom_track_ * *T_track_second_);
    T_odom_track_ = T_odom_track_ * *T_track_second_;
  } else if (is_lost()) {
    begin_anew();
    place_waiting({});
  } else {
    return;
  }
  track_ = std::move(second_);
  T_track_second_.reset();
}

void LaserOdometry::begin(scan::Scan scan, const TimedFeatures& seen) {
  track_.reset();
  if (!LaserTrack::can_begin(*seen.features)) {
    ++counts_.unplaced;
    return;
  }
  track_ = std::make_unique<LaserTrack>(seen);
  place(std::move(scan), {});
}

void LaserOdometry::begin_anew() {
  ++counts_.breaks;
  ++epoch_;
  T_odom_last_.reset();
  T_odom_track_ = {};
}

void LaserOdometry::follow_first(scan::Scan scan, const TimedFeatures& seen,
                                 const LaserStep& step) {
  scan.T_odom_robot = T_odom_track_ * step.T_track_robot;
  if (step.unseen_m > 0.0) {
    held_m_ = step.unseen_m;
    held_.push_back(std::move(scan));
    if (held_m_ <= kMostUnseen_m) return;
    counts_.unseen += held_.size();
    held_.clear();
    return;
  }
  if (place_held()) {
    const Pose2 T_odom_robot = scan.T_odom_robot;
    place(std::move(scan), T_odom_robot);
  } else {
    begin_anew();
    begin(std::move(scan), seen);
  }
}

bool LaserOdometry::place_held() {
  const bool known = std::exchange(held_m_, 0.0) <= kMostUnseen_m;
  for (scan::Scan& scan : std::exchange(held_, {})) {
    const Pose2 T_odom_robot = scan.T_odom_robot;
    place(std::move(scan), T_odom_robot);
  }
  return known;
}

bool LaserOdometry::find_again(const TimedFeatures& seen) {
  LaserTrack trial = *track_;  // each scan is searched for by itself
  track_->skip();
  if (!T_second_last_) return false;
  const std::optional<LaserStep> step = trial.add(seen);
  if (!step) return false;
  const Pose2 T_track_second = step->T_track_robot * geometry::inverse(*T_second_last_);
  const bool again =
      T_track_second_ && same_place(*T_track_second_ * *T_second_last_, step->T_track_robot);
  T_track_second_ = T_track_second;
  return again;
}

void LaserOdometry::follow_second(scan::Scan scan, const TimedFeatures& seen) {
  std::optional<LaserStep> step;
  if (second_) step = second_->add(seen);
  if (!step && LaserTrack::can_begin(*seen.features)) {
    // The scans that the second track placed before fit nothing.
    counts_.unplaced += waiting_.size();
    waiting_.clear();
    second_ = std::make_unique<LaserTrack>(seen);
    T_track_second_.reset();
    step.emplace();
  }
  T_second_last_.reset();
  if (!step) {
    ++counts_.unplaced;
    return;
  }
  T_second_last_ = step->T_track_robot;
  waiting_.push_back({std::move(scan), step->T_track_robot});
}

bool LaserOdometry::is_lost() const {
  return waiting_.size() >= kLostScans && newest_ns_ - waiting_.front().scan.stamp_ns >= kLost_ns;
}

void LaserOdometry::place_waiting(const Pose2& T_odom_second) {
  for (Waiting& waiting : waiting_) {
    place(std::move(waiting.scan), T_odom_second * waiting.T_second_robot);
  }
  waiting_.clear();
}

void LaserOdometry::place(scan::Scan scan, const Pose2& T_odom_robot) {
  if (T_odom_last_) {
    counts_.steps_m.push_back((T_odom_robot.position_m() - T_odom_last_->position_m()).norm());
  }
  T_odom_last_ = T_odom_robot;
  scan.T_odom_robot = T_odom_robot;
  scan.odometry_epoch = epoch_;
  scan.sequence = sequence_++;
  ready_.push_back(std::move(scan));
}

void LaserOdometry::finish() {
  place_held();
  counts_.unplaced += waiting_.size();
  waiting_.clear();
}

std::vector<scan::Scan> LaserOdometry::take() {
  return std::exchange(ready_, {});
}

}  // namespace topogeo::localization
