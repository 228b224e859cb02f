// Odometry poses of a recording over time, for the pose at the time of a scan: they may come late
// and with gaps, and all of them come in the end. That of live odometry is in geometry.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::recording {

class OdometryTrack {
 public:
  /// Longest time between two poses that is interpolated over, unless the robot stood, and longest
  /// time before the first or after the last pose for which that one stands.
  static constexpr std::int64_t kLongestGap_ns = 1'000'000'000;
  static constexpr std::int64_t kLongestHold_ns = 100'000'000;

  /// Poses come about in order of time; of two at one time the last holds.
  void add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);

  /// Whether a pose at or after that time has come.
  [[nodiscard]] bool reaches(std::int64_t stamp_ns) const;

  /// The pose at that time: the one of that stamp as it is, else interpolated linearly, the heading
  /// the shorter way round. Empty where there is none near.
  [[nodiscard]] std::optional<geometry::Pose2> at(std::int64_t stamp_ns) const;

  /// Seconds from that time to the nearest pose; empty without one.
  [[nodiscard]] std::optional<double> distance_s(std::int64_t stamp_ns) const;

  /// Forgets what no scan at or after that time needs.
  void forget_before(std::int64_t stamp_ns);

 private:
  std::deque<geometry::OdometrySample> samples_;  // speeds are not known
};

}  // namespace topogeo::recording
