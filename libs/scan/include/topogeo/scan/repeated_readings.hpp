// Finds the scans of a laser that hangs: its driver sends the last readings again with new stamps
// while the robot drives on.
//
// The noise of a laser changes readings from scan to scan, so that readings that are the same to
// the last digit, although the robot has moved, are old. They would hold the map where they were
// taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::scan {

class RepeatedReadings {
 public:
  /// Fewer beams with an echo may repeat by chance, for instance those of a coarse laser.
  static constexpr std::size_t kFewestEchoes = 20;

  explicit RepeatedReadings(std::size_t fewest_echoes = kFewestEchoes)
      : fewest_echoes_(fewest_echoes) {}

  /// Takes the next scan of one laser: its ranges (kNoReturn without an echo) and its odometry.
  /// Whether it repeats the readings of the scan before it, although by odometry the robot has
  /// moved by more than 1 cm or 0.005 rad since they came first. A scan with few echoes is never a
  /// repetition, nor is one of another odometry epoch.
  bool add(const std::vector<float>& ranges_m, const geometry::Pose2& T_odom_robot,
           std::uint64_t odometry_epoch);

 private:
  std::size_t fewest_echoes_;
  std::vector<float> seen_m_;    // ranges of the last scan ...
  geometry::Pose2 T_odom_seen_;  // ... and the robot's pose when they first came
  std::uint64_t epoch_seen_ = 0;
};

}  // namespace topogeo::scan
