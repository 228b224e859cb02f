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
  if (b.stamp_ns - a.stamp_ns > kLongestGap_ns && !stood(a.T_odom_robot, b.T_odom_robot)) {
    return std::nullopt;
  }
  return geometry::interpolate(a, b, stamp_ns);
}

std::optional<double> OdometryTrack::distance_s(std::int64_t stamp_ns) const {
  if (samples_.empty()) return std::nullopt;
  const auto after =
      std::ranges::lower_bound(samples_, stamp_ns, {}, &geometry::OdometrySample::stamp_ns);
  double nearest_s = 1e18;
  if (after != samples_.end()) {
    nearest_s = static_cast<double>(after->stamp_ns - stamp_ns) * 1e-9;
  }
  if (after != samples_.begin()) {
    nearest_s =
        std::min(nearest_s, static_cast<double>(stamp_ns - std::prev(after)->stamp_ns) * 1e-9);
  }
  return nearest_s;
}

}  // namespace topogeo::recording
