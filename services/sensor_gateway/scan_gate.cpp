#include "scan_gate.hpp"

#include <cmath>
#include <utility>

#include "topogeo/ros_conversions/laser_scan.hpp"

namespace topogeo::sensor_gateway {

std::string_view describe(ScanDrop drop) {
  switch (drop) {
    case ScanDrop::kNoReader:
      return "no reader yet";
    case ScanDrop::kNoOdometry:
      return "no odometry";
    case ScanDrop::kTime:
      return "time not increasing";
    case ScanDrop::kGeometry:
      return "other beam geometry";
    case ScanDrop::kRepeated:
      return "repeated while moving";
  }
  return "unknown";
}

void ScanGate::add(devices::LaserScan scan, std::int64_t now_ns) {
  if (!open_) {
    drop(ScanDrop::kNoReader);
    return;
  }
  waiting_.push_back({std::move(scan), now_ns});
}

std::vector<ScanGate::Leaving> ScanGate::take(std::int64_t now_ns) {
  std::vector<Leaving> scans;
  while (!waiting_.empty()) {
    Waiting& first = waiting_.front();
    const bool bracketed =
        !options_.has_base || (track_.last_ns() && *track_.last_ns() >= first.scan.stamp_ns);
    if (!bracketed && now_ns < due_ns()) break;
    if (std::optional<scan::Scan> scan = finish(std::move(first.scan))) {
      scans.push_back({*std::move(scan), first.arrival_ns});
    }
    waiting_.pop_front();
  }
  return scans;
}

std::int64_t ScanGate::due_ns() const {
  return waiting_.empty() ? std::numeric_limits<std::int64_t>::max()
                          : waiting_.front().arrival_ns + options_.odometry_wait_ns;
}

std::optional<scan::Scan> ScanGate::finish(devices::LaserScan&& scan) {
  const Geometry geometry{scan.angle_min_rad, scan.angle_step_rad, scan.ranges_m.size()};
  if (scan.stamp_ns <= last_stamp_ns_) {
    drop(ScanDrop::kTime);
    return std::nullopt;
  }
  if (geometry_ && geometry != *geometry_) {
    drop(ScanDrop::kGeometry);
    return std::nullopt;
  }
  scan::Scan out;
  if (options_.has_base) {
    const std::optional<geometry::OdometryTrack::Answer> answer = track_.at(scan.stamp_ns);
    if (!answer) {
      drop(ScanDrop::kNoOdometry);
      return std::nullopt;
    }
    if (answer->extrapolated) ++extrapolated_;
    out.T_odom_robot = answer->T_odom_robot;
    out.odometry_epoch = options_.odometry_epoch;
    // A laser that hangs sends old readings with new stamps, which would bend the map.
    if (repeated_.add(scan.ranges_m, out.T_odom_robot, out.odometry_epoch)) {
      drop(ScanDrop::kRepeated);
      return std::nullopt;
    }
  }
  geometry_ = geometry;
  last_stamp_ns_ = scan.stamp_ns;
  out.sequence = next_sequence_++;
  out.stamp_ns = scan.stamp_ns;
  out.angle_min_rad = scan.angle_min_rad;
  out.angle_step_rad = scan.angle_step_rad;
  if (!options_.has_base) {
    // Odometry from the scans takes the motion out.
    out.first_beam_s = scan.first_beam_s;
    out.beam_step_s = scan.time_step_s;
  }
  out.ranges_m = ranges_at_stamp(std::move(scan));
  const auto limit_m = static_cast<float>(options_.range_max_m);
  for (float& range_m : out.ranges_m) {
    if (range_m >= limit_m) range_m = scan::Scan::kNoReturn;
  }
  return out;
}

std::vector<float> ScanGate::ranges_at_stamp(devices::LaserScan&& scan) const {
  if (!options_.has_base || scan.time_step_s == 0.0) return std::move(scan.ranges_m);
  const std::int64_t stamp_ns = scan.stamp_ns;
  const ros::Sweep sweep{{scan.angle_min_rad, scan.angle_step_rad, scan.ranges_m.size()},
                         std::move(scan.ranges_m),
                         scan.time_step_s,
                         scan.first_beam_s};
  return ros::deskewed(sweep, [&](double after_s) -> std::optional<geometry::Pose2> {
    const auto answer = track_.at(stamp_ns + std::llround(1e9 * after_s));
    if (!answer) return std::nullopt;
    return answer->T_odom_robot * options_.T_robot_laser;
  });
}

}  // namespace topogeo::sensor_gateway
