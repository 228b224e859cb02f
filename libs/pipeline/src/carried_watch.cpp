#include "topogeo/pipeline/carried_watch.hpp"

#include <cmath>
#include <cstddef>

namespace topogeo::pipeline {

using geometry::Pose2;

namespace {

// A robot that has moved so little sees nearly the same, even in a doorway.
constexpr double kSameView_m = 0.15;
constexpr double kSameView_rad = 0.2;
// Walls stand no nearer than before, and a laser is never as noisy.
constexpr double kBeyond_m = 0.5;
constexpr double kLeastBeyond = 0.25;  // share of the beams with an echo in both scans
constexpr int kFewestBeams = 20;
// How long the new view must last.
constexpr std::int64_t kStays_ns = 1'000'000'000;
constexpr int kStaysScans = 5;
// A robot that drives on farther within that time has passed a door, behind which a short-sighted
// laser sees nothing that it saw before.
constexpr double kPutDown_m = 0.3;
constexpr double kBetter = 0.2;  // difference in agreement

/// Share of the beams that see beyond what `before` saw, taken at the same place with another
/// heading; 0 with too few beams.
double share_beyond(const scan::Scan& before, const scan::Scan& now, double turn_rad) {
  const auto beams = static_cast<std::ptrdiff_t>(before.ranges_m.size());
  const auto shift = static_cast<std::ptrdiff_t>(std::lround(turn_rad / before.angle_step_rad));
  int common = 0;
  int beyond = 0;
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(now.ranges_m.size()); ++i) {
    const std::ptrdiff_t j = i + shift;
    if (j < 0 || j >= beams) continue;
    const float before_m = before.ranges_m[static_cast<std::size_t>(j)];
    const float now_m = now.ranges_m[static_cast<std::size_t>(i)];
    if (before_m == scan::Scan::kNoReturn || now_m == scan::Scan::kNoReturn) continue;
    ++common;
    if (now_m > before_m + kBeyond_m + kSameView_m) ++beyond;
  }
  return common < kFewestBeams ? 0.0 : static_cast<double>(beyond) / common;
}

}  // namespace

void CarriedWatch::found(const scan::Scan& scan) {
  last_matched_ = scan;
  there_scans_ = 0;
}

CarriedWatch::State CarriedWatch::add(const scan::Scan& scan,
                                      std::span<const topomap::ScanPoint> points,
                                      const localization::TrackedPose& pose) {
  if (there_scans_ > 0) {
    const localization::TrackedPose there = there_.track(points, scan.T_odom_robot);
    // Parallel walls may match the last stop by chance.
    if (there.matched && (!pose.matched || there.agreement > pose.agreement + kBetter)) {
      ++there_scans_;
      const bool stays =
          there_scans_ >= kStaysScans && scan.stamp_ns - there_since_ns_ >= kStays_ns;
      if (!stays) return State::kUnclear;
      const Pose2 moved = geometry::between(last_matched_->T_odom_robot, scan.T_odom_robot);
      if (moved.position_m().norm() < kPutDown_m) return State::kElsewhere;
    }
  }
  there_scans_ = 0;
  if (pose.matched || !last_matched_) {
    found(scan);
    return State::kOnPath;
  }
  if (!contradicts(scan, points)) return State::kOnPath;
  there_.start(points, T_robot_laser_, scan.T_odom_robot);
  there_since_ns_ = scan.stamp_ns;
  there_scans_ = 1;
  return State::kUnclear;
}

bool CarriedWatch::contradicts(const scan::Scan& scan,
                               std::span<const topomap::ScanPoint> points) const {
  const Pose2 moved = geometry::between(last_matched_->T_odom_robot, scan.T_odom_robot);
  if (points.size() < static_cast<std::size_t>(kFewestBeams) ||
      moved.position_m().norm() > kSameView_m || std::fabs(moved.theta_rad) > kSameView_rad) {
    return false;
  }
  return share_beyond(*last_matched_, scan, moved.theta_rad) >= kLeastBeyond;
}

}  // namespace topogeo::pipeline
