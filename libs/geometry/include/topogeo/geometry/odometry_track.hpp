// The odometry of the last seconds. It gives poses between its samples and shortly after the last.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::geometry {

struct OdometrySample {
  std::int64_t stamp_ns = 0;
  Pose2 T_odom_robot;
  double linear_mps = 0.0;     ///< along x of the robot
  double angular_radps = 0.0;  ///< counter-clockwise
};

/// The pose at a time between `a` and the later `b`: x and y on the straight line, the heading by
/// the shorter turn.
Pose2 interpolate(const OdometrySample& a, const OdometrySample& b, std::int64_t stamp_ns);

class OdometryTrack {
 public:
  /// Older samples are dropped.
  static constexpr std::int64_t kKept_ns = 5'000'000'000;

  /// `longest_extrapolation_ns` >= 0: limit for poses after the last sample.
  explicit OdometryTrack(std::int64_t longest_extrapolation_ns)
      : longest_extrapolation_ns_(longest_extrapolation_ns) {}

  /// Adds a sample. Returns false and ignores the sample if it is not newer than the last one.
  bool add(const OdometrySample& sample);
  /// Drops all samples, because they are unrelated to the following ones.
  void clear() { samples_.clear(); }

  /// Stamp of the last sample; empty without one.
  [[nodiscard]] std::optional<std::int64_t> last_ns() const;

  struct Answer {
    Pose2 T_odom_robot;
    bool extrapolated = false;
  };
  /// The pose at `stamp_ns`: interpolated between two samples (see interpolate()), or extrapolated
  /// after the last one along the arc of its speeds. Empty before the first sample, and more than
  /// `longest_extrapolation_ns` after the last.
  [[nodiscard]] std::optional<Answer> at(std::int64_t stamp_ns) const;

 private:
  std::int64_t longest_extrapolation_ns_;
  std::deque<OdometrySample> samples_;
};

}  // namespace topogeo::geometry
