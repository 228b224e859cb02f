// The odometry of a recording without readings that cannot be, one track for each epoch.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/odometry_screen.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/recording/odometry_track.hpp"

namespace topogeo::recording {

class ScreenedOdometry {
 public:
  /// Adds poses in approximate order of time.
  void add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);
  /// Call after the last pose.
  void finish();

  struct Answer {
    geometry::Pose2 T_odom_robot;
    std::uint64_t epoch = 0;  ///< from 0
  };
  /// Like OdometryTrack: in the track of the latest epoch that covers that time or, if none does,
  /// has a pose near it.
  [[nodiscard]] std::optional<Answer> at(std::int64_t stamp_ns) const;
  [[nodiscard]] bool empty() const { return epochs_.empty(); }
  /// Within one epoch if there is one on both sides, else between epochs.
  [[nodiscard]] OdometryTrack::Gap gap_at(std::int64_t stamp_ns) const;

  /// For people, about poses that were left out, further epochs, and a slow rate.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  struct Epoch {
    std::uint64_t number = 0;
    OdometryTrack track;
  };

  void take();

  geometry::OdometryScreen screen_;
  std::vector<Epoch> epochs_;
};

}  // namespace topogeo::recording
