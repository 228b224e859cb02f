// Where the robot is now: the last pose fix, carried on by odometry.
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
  double largest_sigma_m = 0.5;
  /// What is not on the map hides it: a stop is not confirmed, and the next one is. So far the
  /// robot goes on meanwhile; it stood for ever if it waited for a stop that only comes when it
  /// moves.
  double untracked_m = 3.0;
};

class PoseKeeper {
 public:
  explicit PoseKeeper(const PoseKeeperConfig& config);

  void add(const PoseFix& fix);
  void add(const OdometrySample& sample);

  [[nodiscard]] bool has_odometry(std::int64_t now_ns) const;
  /// Nothing without odometry, or when it is too old.
  [[nodiscard]] std::optional<geometry::Pose2> T_odom_robot(std::int64_t now_ns) const;
  /// Pose in the map at a time of the last seconds; nothing when it is not known. At `now_ns` it
  /// is what may be driven by: tracking or not long since, fresh and certain enough.
  [[nodiscard]] std::optional<geometry::Pose2> T_map_robot(std::int64_t at_ns) const;
  [[nodiscard]] std::optional<geometry::Pose2> good_pose(std::int64_t now_ns) const;
  /// Why there is no good pose; one line.
  [[nodiscard]] std::string why_not(std::int64_t now_ns) const;

  /// Stamp of the last fix that is in use; nothing without one.
  [[nodiscard]] std::optional<std::int64_t> fix_ns() const;
  /// The localizer is sure of the last fix.
  [[nodiscard]] bool tracking() const { return fix_ && fix_->tracking; }
  /// There is a fix, but the localizer is not sure of it.
  [[nodiscard]] bool doubtful() const { return fix_ && fix_->located && !fix_->tracking; }
  /// Largest standard deviation of the position, metres.
  [[nodiscard]] double sigma_m() const;
  /// How far the fixes since the last call have moved the robot, metres.
  double take_jump_m();
  /// Distance by odometry since the last call, metres.
  double take_driven_m();

 private:
  void use(const PoseFix& fix);
  [[nodiscard]] bool usable() const;

  PoseKeeperConfig config_;
  geometry::OdometryTrack odometry_;
  std::optional<OdometrySample> last_;
  std::optional<PoseFix> pending_;  ///< its odometry has not come yet
  std::optional<PoseFix> fix_;
  geometry::Pose2 T_map_odom_;
  bool tracked_ = false;  ///< since the pose meant nothing
  double untracked_m_ = 0.0;
  double jump_m_ = 0.0;
  double driven_m_ = 0.0;
};

}  // namespace topogeo::navigation
