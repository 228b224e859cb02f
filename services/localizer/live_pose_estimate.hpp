// Pose of the robot between two stops, from the corrected pose of the last stop, the scans matched
// with its scan, and the odometry since.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localizer {

/// The pose at an odometry reading.
struct PoseOfNow {
  std::int64_t stamp_ns = 0;   ///< of the reading
  std::uint64_t sequence = 0;  ///< of the reading
  localization::UncertainPose T_map_robot;
};

class LivePoseEstimate {
 public:
  explicit LivePoseEstimate(const localization::OdometryNoise& noise) : noise_(noise) {}

  /// The newest odometry reading, with its epoch as in scan::Scan.
  void set_odometry(std::int64_t stamp_ns, std::uint64_t sequence,
                    const geometry::Pose2& T_odom_robot, std::uint64_t epoch);
  /// Whether a newer reading of that epoch has arrived.
  [[nodiscard]] bool has_newer(std::int64_t stamp_ns, std::uint64_t epoch) const {
    return epoch == epoch_ && stamp_ns < stamp_ns_;
  }
  /// The newest scan after that stop; used while it is the last stop.
  void set_tracked(const topomap::StopId& stop, const topomap::TrackedScan& scan);
  /// The robot has made a stop. Its odometry is used unless a newer one has arrived.
  void set_stop(std::shared_ptr<const topomap::LocalMap> map);
  /// The pose of the last stop, as it is corrected now.
  void correct(const topomap::StopPose& pose) { stop_pose_ = pose; }
  /// Sets the same from a command.
  void correct(const geometry::Pose2& T_map_stop, const Eigen::Matrix3d& covariance);

  [[nodiscard]] const topomap::StopPose& stop_pose() const { return stop_pose_; }
  /// A stop has been made.
  [[nodiscard]] bool has_stop() const { return map_ != nullptr; }
  /// Pose of the robot relative to its last stop, by odometry. The identity before the first stop,
  /// and when the odometry has restarted since.
  [[nodiscard]] geometry::Pose2 T_stop_robot() const;
  /// Nothing before the first stop, nor between a restart of the odometry and the first stop after
  /// it.
  [[nodiscard]] std::optional<PoseOfNow> now() const;

 private:
  struct Tracked {
    topomap::StopId stop;
    topomap::TrackedScan scan;
  };

  /// Whether the last stop and the newest odometry have the same origin.
  [[nodiscard]] bool comparable() const { return map_ && map_->odometry_epoch == epoch_; }

  localization::OdometryNoise noise_;
  std::shared_ptr<const topomap::LocalMap> map_;  // of the last stop
  topomap::StopPose stop_pose_;
  std::int64_t stamp_ns_ = 0;  // of the newest odometry
  std::uint64_t sequence_ = 0;
  geometry::Pose2 T_odom_robot_;
  std::uint64_t epoch_ = 0;
  std::optional<Tracked> tracked_;
};

}  // namespace topogeo::localizer
