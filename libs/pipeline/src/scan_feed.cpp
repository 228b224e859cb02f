#include "topogeo/pipeline/scan_feed.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "topogeo/support/format.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using localization::LaserOdometryCounts;

bool apart(const Pose2& a, const Pose2& b, double distance_m, double angle_rad) {
  const Eigen::Vector3d d = geometry::difference(a, b);
  return d.head<2>().norm() > distance_m || std::fabs(d.z()) > angle_rad;
}

}  // namespace

localization::LaserOdometry laser_odometry(const LocalMapperConfig& config) {
  return {config.T_robot_laser, config.local_map.points_range_m};
}

std::optional<scan::Scan> ScanFeed::next() {
  if (!odometry_) return next_();
  while (ready_.empty() && !ended_) {
    if (std::optional<scan::Scan> scan = next_()) {
      odometry_->add(*std::move(scan));
    } else {
      ended_ = true;
      odometry_->finish();
    }
    for (scan::Scan& placed : odometry_->take()) ready_.push_back(std::move(placed));
  }
  if (ready_.empty()) return std::nullopt;
  scan::Scan scan = std::move(ready_.front());
  ready_.pop_front();
  return scan;
}

bool odometry_stands(const NextScan& next) {
  constexpr double kSame_m = 0.01;
  constexpr double kSame_rad = 0.01;
  std::optional<Pose2> first;
  while (const std::optional<scan::Scan> scan = next()) {
    if (!first) first = scan->T_odom_robot;
    if (apart(*first, scan->T_odom_robot, kSame_m, kSame_rad)) return false;
  }
  return true;
}

bool laser_moves(const NextScan& next, localization::LaserOdometry odometry) {
  constexpr double kMoved_m = 0.5;
  constexpr double kMoved_rad = 0.35;
  ScanFeed feed(next, std::move(odometry));
  while (const std::optional<scan::Scan> scan = feed.next()) {
    if (scan->odometry_epoch > 0 || apart({}, scan->T_odom_robot, kMoved_m, kMoved_rad)) {
      return true;
    }
  }
  return false;
}

double usual_step_m(const LaserOdometryCounts& counts) {
  constexpr double kMoved_m = 0.02;  // more than the noise of a standing laser
  std::vector<double> steps_m;
  steps_m.reserve(counts.steps_m.size());
  std::ranges::copy_if(counts.steps_m, std::back_inserter(steps_m),
                       [](double step_m) { return step_m > kMoved_m; });
  if (steps_m.empty()) return 0.0;
  const auto middle = steps_m.begin() + static_cast<std::ptrdiff_t>(steps_m.size() / 2);
  std::ranges::nth_element(steps_m, middle);
  return *middle;
}

std::string too_sparse(const LaserOdometryCounts& counts) {
  // A corridor looks the same one door further, and doors are 0.8 to 1 m wide: scans so far apart
  // match in the wrong place as well (docs/decisions/laser_odometry.md).
  constexpr double kFarthest_m = 0.8;
  constexpr double kMostUnplaced = 0.5;
  constexpr std::uint64_t kFewest = 10;  // a shorter log says little
  const double step_m = usual_step_m(counts);
  if (step_m > kFarthest_m) {
    return fmt::format(
        "the scans are too sparse for odometry from them: successive ones are {:.2f} m apart, "
        "expected at most {:.1f} m",
        step_m, kFarthest_m);
  }
  const auto unplaced = static_cast<double>(counts.unplaced);
  if (counts.scans >= kFewest && unplaced > kMostUnplaced * static_cast<double>(counts.scans)) {
    return fmt::format(
        "the scans are too sparse for odometry from them: {} of {} do not match those before them",
        counts.unplaced, counts.scans);
  }
  const auto unseen = static_cast<double>(counts.unseen);
  if (counts.scans >= kFewest && unseen > kMostUnplaced * static_cast<double>(counts.scans)) {
    return fmt::format(
        "the scans do not show how far the robot drives: {} of {} see only bare walls, expected "
        "odometry of wheels, or a laser that sees farther",
        counts.unseen, counts.scans);
  }
  return {};
}

}  // namespace topogeo::pipeline
