#include "topogeo/topomap/trajectory.hpp"

#include <stdexcept>
#include <string>

namespace topogeo::topomap {

namespace {

void check_sizes(const Trajectory& trajectory, std::span<const LocalMap> maps, const char* who) {
  if (trajectory.stops.size() != maps.size()) {
    throw std::invalid_argument(std::string(who) + ": expected one stop for each local map, got " +
                                std::to_string(trajectory.stops.size()) + " for " +
                                std::to_string(maps.size()));
  }
}

/// Appends the odometry poses of a stop and of the scans that lead to it.
void append_odometry(const LocalMap& map, const geometry::Pose2& T_map_odom,
                     std::vector<StampedPose>& poses) {
  for (const TrackedScan& scan : map.track) {
    poses.push_back({scan.sequence, scan.stamp_ns, T_map_odom * scan.T_odom_robot});
  }
  poses.push_back({map.sequence, map.stamp_ns, T_map_odom * map.T_odom_robot});
}

}  // namespace

std::vector<StampedPose> expand_trajectory(const Trajectory& trajectory,
                                           std::span<const LocalMap> maps) {
  check_sizes(trajectory, maps, "expand_trajectory");
  std::vector<StampedPose> poses;
  const StopPose start;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const StopPose& before = i == 0 ? start : trajectory.stops[i - 1];
    for (const TrackedScan& scan : maps[i].track) {
      if (!before.located) break;
      poses.push_back({scan.sequence, scan.stamp_ns, before.T_map_robot * scan.T_stop_robot});
    }
    if (!trajectory.stops[i].located) continue;
    poses.push_back({maps[i].sequence, maps[i].stamp_ns, trajectory.stops[i].T_map_robot});
  }
  return poses;
}

std::vector<StampedPose> expand_odometry(const Trajectory& trajectory,
                                         std::span<const LocalMap> maps) {
  check_sizes(trajectory, maps, "expand_odometry");
  std::vector<StampedPose> poses;
  geometry::Pose2 T_map_odom;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (i == 0) T_map_odom = inverse(maps[i].T_odom_robot);
    if (i > 0 && !has_odometry_between(maps[i - 1], maps[i])) {
      T_map_odom = trajectory.stops[i].T_map_robot * inverse(maps[i].T_odom_robot);
    }
    append_odometry(maps[i], T_map_odom, poses);
  }
  return poses;
}

std::vector<StampedPose> expand_odometry(std::span<const LocalMap> maps) {
  std::vector<StampedPose> poses;
  if (maps.empty()) return poses;
  const geometry::Pose2 T_map_odom = inverse(maps.front().T_odom_robot);
  for (const LocalMap& map : maps) append_odometry(map, T_map_odom, poses);
  return poses;
}

}  // namespace topogeo::topomap
