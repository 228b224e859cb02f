// A made-up map: a robot in a ring corridor of 20 m x 12 m, rotated by 0.3 rad in the map frame.
#pragma once

#include <cmath>
#include <vector>

#include "topogeo/render/map_picture.hpp"

namespace topogeo::render {

struct SampleFloor {
  std::vector<topomap::LocalMap> maps;
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> closures;
  topomap::GlobalMap global;
  std::vector<topomap::StampedPose> odometry;
  std::vector<topomap::StampedPose> corrected;

  [[nodiscard]] MapPicture picture() const {
    return {maps,    trajectory.stops,        odometry, corrected, closures,
            &global, "Made-up ring corridor", {}};
  }
};

/// Point of the ring's middle line, 20 m x 12 m, after a path of `s_m` (64 m around).
inline Eigen::Vector2d ring_point(double s_m) {
  s_m = std::fmod(s_m, 64.0);
  if (s_m < 20.0) return {s_m, 0.0};
  if (s_m < 32.0) return {20.0, s_m - 20.0};
  if (s_m < 52.0) return {52.0 - s_m, 12.0};
  return {0.0, 64.0 - s_m};
}

/// All wall points (inner and outer, 1 m from the middle line) within 6 m of a point, wall by wall.
inline std::vector<Eigen::Vector2d> walls_near(const Eigen::Vector2d& centre) {
  std::vector<Eigen::Vector2d> points;
  for (const double offset_m : {-1.0, 1.0}) {
    const double x0 = offset_m;
    const double x1 = 20.0 - offset_m;
    const double y1 = 12.0 - offset_m;
    const auto keep = [&](const Eigen::Vector2d& p) {
      if ((p - centre).norm() < 6.0) points.push_back(p);
    };
    for (double x = x0; x < x1; x += 0.04) keep({x, x0});
    for (double y = x0; y < y1; y += 0.04) keep({x1, y});
    for (double x = x1; x > x0; x -= 0.04) keep({x, y1});
    for (double y = y1; y > x0; y -= 0.04) keep({x0, y});
  }
  return points;
}

inline SampleFloor sample_floor() {
  SampleFloor floor;
  const geometry::Pose2 T_map_floor{0.0, 0.0, 0.3};
  for (std::uint32_t id = 0; id < 33; ++id) {
    const double s_m = 2.0 * id;
    const Eigen::Vector2d at = ring_point(s_m);
    // A little off the middle line, so that path and branches can be distinguished.
    const geometry::Pose2 T_floor_robot{at.x() + 0.3 * (id % 3), at.y() - 0.2 * (id % 4), 0.1 * id};
    const geometry::Pose2 T_map_robot = T_map_floor * T_floor_robot;
    topomap::LocalMap map;
    map.id = id;
    for (const Eigen::Vector2d& p : walls_near(at)) {
      const Eigen::Vector2d in_robot = geometry::inverse(T_floor_robot) * p;
      map.points.push_back({static_cast<float>(in_robot.x()), static_cast<float>(in_robot.y())});
    }
    floor.maps.push_back(map);
    floor.trajectory.stops.push_back({id, 0, T_map_robot, Eigen::Matrix3d::Zero()});
    floor.corrected.push_back({id, 0, T_map_robot});
    // Odometry drifts to the left.
    const geometry::Pose2 drift{0.02 * s_m, 0.01 * s_m, 0.003 * s_m};
    floor.odometry.push_back({id, 0, drift * T_map_robot});
  }
  floor.closures = {{0, 32, {}}, {1, 31, {}}};
  for (std::uint32_t i = 0; i < 32; ++i) {
    const Eigen::Vector2d at = T_map_floor * ring_point(2.0 * i);
    floor.global.nodes.push_back({i, static_cast<topomap::NodeKind>(i % 6), at, 1.0, 1});
    topomap::MapBranch branch{i, i, (i + 1) % 32, i % 8 == 7, 1, {}};
    for (int k = 0; k <= 4; ++k) {
      branch.points.push_back({T_map_floor * ring_point(2.0 * i + 0.5 * k), 1.0});
    }
    floor.global.branches.push_back(branch);
  }
  return floor;
}

}  // namespace topogeo::render
