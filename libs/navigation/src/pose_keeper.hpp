// Current pose of the robot: the last pose fix, carried on by odometry.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

struct PoseKeeperConfig {
  double oldest_pose_s = 3.0;
  double oldest_odometry_s = 1.0;
  double largest_sigma_m = 0.5;  ///< where the position is known best; see kLengthwise
  /// Largest distance without tracking. Unmapped objects may hide the map, so that a stop is not
  /// confirmed but the next one is. A robot that waited for it would stand forever, because a stop
  /// needs motion.
  double untracked_m = 3.0;
};

class PoseKeeper {
 public:
  explicit PoseKeeper(const PoseKeeperConfig& config);

  void add(const PoseFix& fix);
  void add(const OdometrySample& sample);

  [[nodiscard]] bool has_odometry(std::int64_t now_ns) const;
  /// Nothing without odometry, or if it is too old.
  [[nodiscard]] std::optional<geometry::Pose2> T_odom_robot(std::int64_t now_ns) const;
  /// Pose in the map at a time of the last seconds; nothing if unknown. At `now_ns` it is only
  /// returned if it is good enough to drive: tracking until recently, fresh and certain.
  [[nodiscard]] std::optional<geometry::Pose2> T_map_robot(std::int64_t at_ns) const;
  [[nodiscard]] std::optional<geometry::Pose2> good_pose(std::int64_t now_ns) const;
  /// The reason why there is no good pose; one line.
  [[nodiscard]] std::string why_not(std::int64_t now_ns) const;

  /// Stamp of the last fix in use; nothing without one.
  [[nodiscard]] std::optional<std::int64_t> fix_ns() const;
  /// Whether the localizer is certain of the last fix.
  [[nodiscard]] bool tracking() const { return fix_ && fix_->tracking; }
  /// Whether there is a fix of which the localizer is not certain.
  [[nodiscard]] bool doubtful() const { return fix_ && fix_->located && !fix_->tracking; }
  /// Largest standard deviation of the position, metres.
  [[nodiscard]] double sigma_m() const;
  /// Multiple of largest_sigma_m that is allowed in the other direction. A bare corridor shows
  /// where its walls are, and not how far along it the robot is; nothing there leads through a
  /// door, and where something does, the position is known again.
  static constexpr double kLengthwise = 4.0;
  /// Displacement of the robot by the fixes since the last call, metres.
  double take_jump_m();
  /// Distance by odometry since the last call, metres.
  double take_driven_m();

 private:
  void use(const PoseFix& fix);
  [[nodiscard]] bool usable() const;
  [[nodiscard]] bool certain() const;

  PoseKeeperConfig config_;
  geometry::OdometryTrack odometry_;
  std::optional<OdometrySample> last_;
  std::optional<PoseFix> pending_;  ///< waits for its odometry
  std::optional<PoseFix> fix_;
  geometry::Pose2 T_map_odom_;
  bool tracked_ = false;  ///< since the last unusable pose
  double untracked_m_ = 0.0;
  double jump_m_ = 0.0;
  double driven_m_ = 0.0;
};

}  // namespace topogeo::navigation
