#include "topogeo/geometry/odometry_track.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::geometry {

namespace {

/// The chord of the arc, which equals the arc for the small turns between two reports.
Pose2 extrapolate(const OdometrySample& last, std::int64_t stamp_ns) {
  const double time_s = static_cast<double>(stamp_ns - last.stamp_ns) * 1e-9;
  const double distance_m = last.linear_mps * time_s;
  const double turn_rad = last.angular_radps * time_s;
  const Pose2 step{distance_m * std::cos(turn_rad / 2.0), distance_m * std::sin(turn_rad / 2.0),
                   wrap_angle(turn_rad)};
  return last.T_odom_robot * step;
}

}  // namespace

Pose2 interpolate(const OdometrySample& a, const OdometrySample& b, std::int64_t stamp_ns) {
  const double share =
      static_cast<double>(stamp_ns - a.stamp_ns) / static_cast<double>(b.stamp_ns - a.stamp_ns);
  const Pose2& from = a.T_odom_robot;
  const Pose2& to = b.T_odom_robot;
  return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
          wrap_angle(from.theta_rad + share * wrap_angle(to.theta_rad - from.theta_rad))};
}

bool OdometryTrack::add(const OdometrySample& sample) {
  if (!samples_.empty() && sample.stamp_ns <= samples_.back().stamp_ns) return false;
  samples_.push_back(sample);
  while (samples_.front().stamp_ns < sample.stamp_ns - kKept_ns) samples_.pop_front();
  return true;
}

std::optional<std::int64_t> OdometryTrack::last_ns() const {
  if (samples_.empty()) return std::nullopt;
  return samples_.back().stamp_ns;
}

std::optional<OdometryTrack::Answer> OdometryTrack::at(std::int64_t stamp_ns) const {
  if (samples_.empty() || stamp_ns < samples_.front().stamp_ns) return std::nullopt;
  const OdometrySample& last = samples_.back();
  if (stamp_ns > last.stamp_ns) {
    if (stamp_ns - last.stamp_ns > longest_extrapolation_ns_) return std::nullopt;
    return Answer{extrapolate(last, stamp_ns), true};
  }
  const auto after = std::lower_bound(
      samples_.begin(), samples_.end(), stamp_ns,
      [](const OdometrySample& sample, std::int64_t at) { return sample.stamp_ns < at; });
  if (after->stamp_ns == stamp_ns) return Answer{after->T_odom_robot, false};
  return Answer{interpolate(*(after - 1), *after, stamp_ns), false};
}

}  // namespace topogeo::geometry
