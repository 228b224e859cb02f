#include "topogeo/topomap/trajectory.hpp"

#include <stdexcept>

namespace topogeo::topomap {

std::vector<StampedPose> expand_trajectory(const Trajectory& trajectory,
                                           std::span<const LocalMap> maps) {
  if (trajectory.stops.size() != maps.size()) {
    throw std::invalid_argument("expand_trajectory: as many stops as local maps are needed");
  }
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    for (const TrackedScan& scan : maps[i].track) {
      const geometry::Pose2 T_map_stop =
          i == 0 ? geometry::Pose2{} : trajectory.stops[i - 1].T_map_robot;
      poses.push_back({scan.sequence, scan.stamp_ns, T_map_stop * scan.T_stop_robot});
    }
    poses.push_back({maps[i].sequence, maps[i].stamp_ns, trajectory.stops[i].T_map_robot});
  }
  return poses;
}

std::vector<StampedPose> expand_odometry(std::span<const LocalMap> maps) {
  std::vector<StampedPose> poses;
  if (maps.empty()) return poses;
  const geometry::Pose2 T_odom_first = maps.front().T_odom_robot;
  for (const LocalMap& map : maps) {
    for (const TrackedScan& scan : map.track) {
      poses.push_back({scan.sequence, scan.stamp_ns, between(T_odom_first, scan.T_odom_robot)});
    }
    poses.push_back({map.sequence, map.stamp_ns, between(T_odom_first, map.T_odom_robot)});
  }
  return poses;
}

}  // namespace topogeo::topomap
