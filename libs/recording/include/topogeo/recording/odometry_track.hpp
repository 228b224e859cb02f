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
  /// Slower odometry is interpolated over up to two and a half of its periods and this time, if the
  /// robot moved so little meanwhile: where it was on the path is not known better.
  static constexpr std::int64_t kLongestSlowGap_ns = 5'000'000'000;
  static constexpr double kFarthestStep_m = 2.0;
  static constexpr double kLargestTurn_rad = 1.6;

  /// Adds poses in approximate order of time; the last one at a time counts.
  void add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);

  /// Call after the last pose: finds the period.
  void finish();

  /// Median time between poses; 0 with fewer than two or before finish().
  [[nodiscard]] std::int64_t period_ns() const { return period_ns_; }

  /// Whether there are poses at or before and at or after `stamp_ns`.
  [[nodiscard]] bool covers(std::int64_t stamp_ns) const;

  /// The pose at `stamp_ns`: a pose with that stamp unchanged, otherwise interpolated linearly,
  /// with the heading along the shorter turn. Empty if none is near.
  [[nodiscard]] std::optional<geometry::Pose2> at(std::int64_t stamp_ns) const;

  struct Gap {
    std::optional<std::int64_t> before_ns;  ///< stamp of the last pose before it
    std::optional<std::int64_t> after_ns;   ///< stamp of the first pose after it
    double step_m = 0.0;                    ///< between the two
    double turn_rad = 0.0;                  ///< the same, >= 0
  };
  /// The poses on both sides of `stamp_ns`.
  [[nodiscard]] Gap gap_at(std::int64_t stamp_ns) const;

 private:
  [[nodiscard]] bool bridges(const geometry::OdometrySample& a,
                             const geometry::OdometrySample& b) const;

  std::vector<geometry::OdometrySample> samples_;  // speeds are unknown
  std::int64_t period_ns_ = 0;
};

}  // namespace topogeo::recording
