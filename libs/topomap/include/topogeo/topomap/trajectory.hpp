// The corrected trajectory of a robot: one pose per stop, and from these one per scan.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

/// Pose of a stop in the map frame, whose origin is the first stop.
struct StopPose {
  std::uint32_t local_map_id = 0;
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_map_robot;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< of (x, y, theta) in the map frame, m and rad
  StopId stop{};
  bool located = true;      ///< false: the robot was not located, the pose is meaningless
  std::uint32_t views = 1;  ///< number of views it stands for: its own and those that were dropped
                            ///< since because they showed the same
  std::int64_t last_view_ns = 0;  ///< stamp of the last dropped view; 0: none

  /// Time of the last view like this of its place.
  [[nodiscard]] std::int64_t last_seen_ns() const { return std::max(stamp_ns, last_view_ns); }
};

struct Trajectory {
  std::uint64_t version = 0;    ///< grows with every change
  std::vector<StopPose> stops;  ///< index = local map id
  /// Last version in which stops left the map or were forgotten, so that later stops got new ids;
  /// 0: never.
  std::uint64_t numbered_since = 0;
};

/// A closed loop: two stops far apart on the path whose maps were matched.
struct LoopClosure {
  std::uint32_t earlier_id = 0;  ///< local map ids
  std::uint32_t later_id = 0;
  geometry::Pose2 T_earlier_later;
};

/// Pose of one scan, stop or not.
struct StampedPose {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
  geometry::Pose2 pose;
};

/// One corrected pose (T_map_robot) per scan in time order: stops as in `trajectory`, the scans in
/// between moved rigidly with the previous stop. Stops that are not located, and the scans that
/// follow them, are left out. `maps[i]` is the map of `trajectory.stops[i]`.
std::vector<StampedPose> expand_trajectory(const Trajectory& trajectory,
                                           std::span<const LocalMap> maps);

/// The odometry poses (T_odom_robot) of all scans, moved so that the first is the identity and the
/// first of each later drive has its pose in `trajectory`. `maps[i]` is the map of
/// `trajectory.stops[i]`.
std::vector<StampedPose> expand_odometry(const Trajectory& trajectory,
                                         std::span<const LocalMap> maps);
/// The same for maps of one drive.
std::vector<StampedPose> expand_odometry(std::span<const LocalMap> maps);

}  // namespace topogeo::topomap
