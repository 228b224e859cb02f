#include "topogeo/recording/odometry_track.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace topogeo::recording {
namespace {

// Odometry motion of a standing robot, at most.
constexpr double kStands_m = 0.01;
constexpr double kStands_rad = 0.01;

bool stood(const geometry::Pose2& a, const geometry::Pose2& b) {
  const Eigen::Vector3d apart = geometry::difference(a, b);
  return apart.head<2>().norm() <= kStands_m && std::fabs(apart.z()) <= kStands_rad;
}

}  // namespace

void OdometryTrack::add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot) {
  auto place = samples_.end();
  while (place != samples_.begin() && std::prev(place)->stamp_ns >= stamp_ns) --place;
  if (place != samples_.end() && place->stamp_ns == stamp_ns) {
    place->T_odom_robot = T_odom_robot;
    return;
  }
  samples_.insert(place, {stamp_ns, T_odom_robot, 0.0, 0.0});
}

bool OdometryTrack::covers(std::int64_t stamp_ns) const {
  return !samples_.empty() && samples_.front().stamp_ns <= stamp_ns &&
         stamp_ns <= samples_.back().stamp_ns;
}

std::optional<geometry::Pose2> OdometryTrack::at(std::int64_t stamp_ns) const {
  if (samples_.empty()) return std::nullopt;
  const auto after =
      std::ranges::lower_bound(samples_, stamp_ns, {}, &geometry::OdometrySample::stamp_ns);
  if (after != samples_.end() && after->stamp_ns == stamp_ns) return after->T_odom_robot;
  if (after == samples_.begin() || after == samples_.end()) {
    const geometry::OdometrySample& nearest = after == samples_.end() ? samples_.back() : *after;
    if (std::llabs(nearest.stamp_ns - stamp_ns) > kLongestHold_ns) return std::nullopt;
    return nearest.T_odom_robot;
  }
  const geometry::OdometrySample& a = *std::prev(after);
  const geometry::OdometrySample& b = *after;
  if (!bridges(a, b)) return std::nullopt;
  return geometry::interpolate(a, b, stamp_ns);
}

/// Whether the poses between two samples are known well enough.
bool OdometryTrack::bridges(const geometry::OdometrySample& a,
                            const geometry::OdometrySample& b) const {
  const std::int64_t gap_ns = b.stamp_ns - a.stamp_ns;
  if (gap_ns <= kLongestGap_ns || stood(a.T_odom_robot, b.T_odom_robot)) return true;
  if (gap_ns > std::min(period_ns_ * 5 / 2, kLongestSlowGap_ns)) return false;
  const geometry::Pose2 step = geometry::between(a.T_odom_robot, b.T_odom_robot);
  return step.position_m().norm() <= kFarthestStep_m &&
         std::fabs(step.theta_rad) <= kLargestTurn_rad;
}

void OdometryTrack::finish() {
  if (samples_.size() < 2) return;
  std::vector<std::int64_t> periods_ns;
  periods_ns.reserve(samples_.size() - 1);
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    periods_ns.push_back(samples_[i].stamp_ns - samples_[i - 1].stamp_ns);
  }
  const auto middle = periods_ns.begin() + static_cast<std::ptrdiff_t>(periods_ns.size() / 2);
  std::ranges::nth_element(periods_ns, middle);
  period_ns_ = *middle;
}

OdometryTrack::Gap OdometryTrack::gap_at(std::int64_t stamp_ns) const {
  const auto after =
      std::ranges::lower_bound(samples_, stamp_ns, {}, &geometry::OdometrySample::stamp_ns);
  Gap gap;
  if (after != samples_.end()) gap.after_ns = after->stamp_ns;
  if (after != samples_.begin()) gap.before_ns = std::prev(after)->stamp_ns;
  if (gap.before_ns && gap.after_ns) {
    const geometry::Pose2 step =
        geometry::between(std::prev(after)->T_odom_robot, after->T_odom_robot);
    gap.step_m = step.position_m().norm();
    gap.turn_rad = std::fabs(step.theta_rad);
  }
  return gap;
}

}  // namespace topogeo::recording
