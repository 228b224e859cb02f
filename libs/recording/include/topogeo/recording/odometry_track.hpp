// All odometry poses of a recording, with its gaps. A scan gets its pose from here.
// The track of live odometry is geometry::OdometryTrack.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::recording {

class OdometryTrack {
 public:
  /// Longest time between two poses that are interpolated. It does not apply to a robot at rest.
  static constexpr std::int64_t kLongestGap_ns = 1'000'000'000;
  /// The first pose also counts for this time before it, the last pose for this time after it.
  static constexpr std::int64_t kLongestHold_ns = 100'000'000;
  /// Slow odometry is interpolated over at most 2.5 of its periods and at most this time, if the
  /// robot moved no farther than the two limits below, because nothing better is known.
  static constexpr std::int64_t kLongestSlowGap_ns = 5'000'000'000;
  static constexpr double kFarthestStep_m = 2.0;
  static constexpr double kLargestTurn_rad = 1.6;

  /// Adds a pose. Poses come in approximate order of time; of equal stamps the last one counts.
  void add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);

  /// Finds the period; must be called after the last pose and before at().
  void finish();

  /// Median time between poses; 0 with fewer than two or before finish().
  [[nodiscard]] std::int64_t period_ns() const { return period_ns_; }

  /// Whether there are poses at or before and at or after `stamp_ns`.
  [[nodiscard]] bool covers(std::int64_t stamp_ns) const;

  /// The pose at `stamp_ns`. A pose with that stamp is returned unchanged; others are interpolated
  /// linearly, with the heading along the shorter turn. Empty if no pose is near.
  [[nodiscard]] std::optional<geometry::Pose2> at(std::int64_t stamp_ns) const;

  struct Gap {
    std::optional<std::int64_t> before_ns;  ///< stamp of the last pose before the time asked for
    std::optional<std::int64_t> after_ns;   ///< stamp of the first pose after it
    double step_m = 0.0;                    ///< distance between the two poses
    double turn_rad = 0.0;                  ///< turn between the two poses, >= 0
  };
  /// The poses on both sides of `stamp_ns`.
  [[nodiscard]] Gap gap_at(std::int64_t stamp_ns) const;

 private:
  [[nodiscard]] bool bridges(const geometry::OdometrySample& a,
                             const geometry::OdometrySample& b) const;

  std::vector<geometry::OdometrySample> samples_;  // their speeds are unset
  std::int64_t period_ns_ = 0;
};

}  // namespace topogeo::recording
