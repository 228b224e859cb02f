// Two drives on one floor with arbitrary odometry starts: parts of a map that meet late.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/topomap/trajectory.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization::test {

/// A drive of one robot, with arbitrary odometry start.
struct RobotDrive {
  Maps maps;
  std::vector<geometry::Pose2> T_world_robot;
};

inline RobotDrive robot_drive(const DrivenMaps& driven, const std::string& robot,
                              std::uint64_t session) {
  RobotDrive out;
  out.T_world_robot = driven.T_world_robot;
  const geometry::Pose2 T_other_odom{10.0 * static_cast<double>(session), -3.0, 1.0};
  for (const auto& given : driven.maps) {
    topomap::LocalMap map = *given;
    map.robot_id = robot;
    map.stop = {session, map.id};
    map.T_odom_robot = T_other_odom * map.T_odom_robot;
    for (topomap::TrackedScan& scan : map.track) {
      scan.T_odom_robot = T_other_odom * scan.T_odom_robot;
    }
    out.maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(map)));
  }
  return out;
}

/// The floor: `a` drives east along the south corridor, up the east one and back along the north
/// one; `b` begins in the north west, comes down the west corridor to the start of `a`, and follows
/// it along the south corridor.
inline const RobotDrive& drive_a() {
  static const RobotDrive out = robot_drive(
      drive(world("floor"),
            {{1.3, 1.2}, {15.0, 1.15}, {28.9, 1.2}, {28.9, 9.0}, {28.8, 18.7}, {15.0, 18.8}}),
      "a", 21);
  return out;
}
inline const RobotDrive& drive_b() {
  static const RobotDrive out = robot_drive(
      drive(world("floor"),
            {{8.0, 18.8}, {1.3, 18.8}, {1.3, 9.6}, {1.3, 1.2}, {15.0, 1.15}, {24.0, 1.2}}),
      "b", 22);
  return out;
}

inline geometry::Pose2 truth(const topomap::StopId& stop) {
  return (stop.session == 21 ? drive_a() : drive_b()).T_world_robot[stop.number];
}

/// Largest distance of a stop from its true place, with the map's first one at its true place.
inline double largest_error_m(const topomap::Trajectory& trajectory) {
  double largest_m = 0.0;
  const topomap::StopPose& first = trajectory.stops.front();
  for (const topomap::StopPose& stop : trajectory.stops) {
    const geometry::Pose2 T_true = geometry::between(truth(first.stop), truth(stop.stop));
    const geometry::Pose2 T = geometry::between(first.T_map_robot, stop.T_map_robot);
    largest_m = std::max(largest_m, geometry::between(T_true, T).position_m().norm());
  }
  return largest_m;
}

inline Maps one_after_the_other(const Maps& first, const Maps& second) {
  Maps out = first;
  out.insert(out.end(), second.begin(), second.end());
  return out;
}

}  // namespace topogeo::localization::test
