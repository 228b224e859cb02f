// Odometry poses of a recording, for the pose at the time of a scan: with gaps, but all are known.
// The track of live odometry is in geometry.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::recording {

class OdometryTrack {
 public:
  /// Longest time between two poses for interpolation, unless the robot stood, and longest time
  /// before the first or after the last pose for which that pose is used.
  static constexpr std::int64_t kLongestGap_ns = 1'000'000'000;
  static constexpr std::int64_t kLongestHold_ns = 100'000'000;

  /// Adds poses in approximate order of time; the last one at a time counts.
  void add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);

  /// Whether there are poses at or before and at or after `stamp_ns`.
  [[nodiscard]] bool covers(std::int64_t stamp_ns) const;

  /// The pose at `stamp_ns`: a pose with that stamp unchanged, otherwise interpolated linearly,
  /// with the heading along the shorter turn. Empty if none is near.
  [[nodiscard]] std::optional<geometry::Pose2> at(std::int64_t stamp_ns) const;

  /// Seconds between `stamp_ns` and the nearest pose; empty without one.
  [[nodiscard]] std::optional<double> distance_s(std::int64_t stamp_ns) const;

 private:
  std::vector<geometry::OdometrySample> samples_;  // speeds are unknown
};

}  // namespace topogeo::recording
