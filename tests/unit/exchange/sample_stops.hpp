// Stops of two drives along a corridor of 2 m between two walls, made up.
#pragma once

#include <cmath>
#include <numbers>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// Beams from -90 degrees, a degree apart, in a room with walls at y = 1 and y = -1, x = 9 and x =
/// -1; the robot is at `x_m`.
inline std::vector<topomap::ScanPoint> corridor_points(double x_m) {
  std::vector<topomap::ScanPoint> points;
  for (int i = 0; i <= 180; ++i) {
    const double angle = (i - 90) * std::numbers::pi / 180.0;
    const double dx = std::cos(angle);
    const double dy = std::sin(angle);
    double range_m = 1e9;
    if (dx > 1e-9) range_m = std::min(range_m, (9.0 - x_m) / dx);
    if (std::fabs(dy) > 1e-9) range_m = std::min(range_m, 1.0 / std::fabs(dy));
    if (i % 7 == 3) continue;  // no echo
    points.push_back({static_cast<float>(range_m * dx), static_cast<float>(range_m * dy)});
  }
  return points;
}

/// Four stops a metre apart, then two of a later drive; the loop between the first and the fourth
/// agrees with the rest. The fifth is not located: its pose has no meaning.
inline storage::MapDocument sample_stops() {
  storage::MapDocument document;
  document.robot_id = "robot-1";
  document.seed = 42;
  document.trajectory.version = 9;
  for (std::uint32_t id = 0; id < 6; ++id) {
    const bool second = id >= 4;
    topomap::LocalMap map;
    map.robot_id = "robot-1";
    map.id = id;
    map.sequence = std::uint64_t{10} * id;
    map.stamp_ns = 1'000'000'000LL * (id + 1);
    map.starts_drive = id == 4;
    const double x_m = second ? id - 4.0 : id;
    map.T_odom_robot = {x_m, 0.0, 0.0};
    if (id != 0 && id != 4) map.T_previous_robot = {1.0, 0.0, 0.0};
    map.points = corridor_points(x_m);
    document.local_maps.push_back(map);
    topomap::StopPose stop;
    stop.local_map_id = id;
    stop.stamp_ns = map.stamp_ns;
    stop.T_map_robot = {x_m, 0.0, 0.0};
    stop.covariance = Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal();
    stop.located = id != 4;
    document.trajectory.stops.push_back(stop);
  }
  // Adds a scan between them that was no stop.
  document.local_maps[5].track = {{45, 5'500'000'000, {0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}, true}};
  document.loop_closures = {{0, 3, {3.0, 0.0, 0.0}}};
  return document;
}

}  // namespace topogeo::exchange
