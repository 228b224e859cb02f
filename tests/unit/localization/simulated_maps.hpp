// Local maps and logs of the simulated worlds in share/worlds, with the true poses, for the tests
// of matching and for the benchmarks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

namespace topogeo::localization::test {

/// share/worlds/NAME.world.yaml.
inline world::World world(const std::string& name) {
  return world::load_world(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "share" / "worlds" /
                           (name + ".world.yaml"));
}

/// Readings of a laser at the robot's origin for a true pose.
inline scan::Scan scan_at(const world::World& world, const geometry::Pose2& T_world_robot,
                          std::uint64_t seed) {
  const simulation::BeamPattern beams;
  support::Random random(seed);
  scan::Scan scan;
  scan.angle_min_rad = beams.angle_min_rad;
  scan.angle_step_rad = beams.angle_step_rad;
  scan.ranges_m = simulation::measure(simulation::raycast(world, T_world_robot, beams), {}, random);
  scan.T_odom_robot = T_world_robot;
  return scan;
}

/// The local map of one stop at a true pose, with the same odometry.
inline topomap::LocalMap map_at(const world::World& world, const geometry::Pose2& T_world_robot,
                                std::uint32_t id) {
  const scan::Scan scan = scan_at(world, T_world_robot, 100 + id);
  voronoi::LocalVoronoi voronoi{voronoi::VoronoiConfig{}};
  voronoi::LocalVoronoiDiagram diagram;
  voronoi.compute(scan, diagram);
  topomap::LocalMap map;
  map.robot_id = "robot";
  map.id = id;
  map.stop = {1, id};
  map.stamp_ns = 1'000'000'000LL * (id + 1);
  map.T_odom_robot = T_world_robot;
  topomap::build_local_map(diagram, scan, {}, topomap::LocalMapConfig{}, map);
  return map;
}

/// A task with independent deviations of the prediction; the search space is its 95 % rectangle.
inline MatchTask task_between(const topomap::LocalMap& reference, const topomap::LocalMap& query,
                              const geometry::Pose2& T_predicted, double sigma_m,
                              double sigma_rad) {
  MatchTask task;
  task.task_id = 7;
  task.reference_map_id = reference.id;
  task.query_map_id = query.id;
  task.reference_hash = topomap::content_hash(reference);
  task.query_hash = topomap::content_hash(query);
  task.T_reference_query = T_predicted;
  task.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad;
  task.half_width = search_half_width(task.covariance, 0.95, 2.0);
  task.seed = 11;
  return task;
}

using Maps = std::vector<std::shared_ptr<const topomap::LocalMap>>;

/// A drive through a world: the local maps of its stops and the truth at each.
struct DrivenMaps {
  Maps maps;
  std::vector<geometry::Pose2> T_world_robot;  ///< index = local map id
};

/// Drives `tour_m` (the world's own tour when empty) with the simulation's default drift.
inline DrivenMaps drive(world::World world, const std::vector<Eigen::Vector2d>& tour_m,
                        double scan_step_m = 0.33) {
  if (!tour_m.empty()) world.tour_m = tour_m;
  simulation::SimulationOptions options;
  options.scan_step_m = scan_step_m;
  const simulation::SimulatedLog log = simulation::simulate_log(world, options);
  pipeline::LocalMapper mapper({}, "robot");
  DrivenMaps driven;
  const auto keep = [&](std::optional<topomap::LocalMap> map) {
    if (!map) return;
    driven.T_world_robot.push_back(log.T_world_robot[map->sequence]);
    driven.maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
  };
  for (const scan::Scan& scan : log.scans) keep(mapper.add(scan));
  keep(mapper.finish());
  return driven;
}

/// Once round the floor and 10 m on: 110 m of corridors; the last stops see the first places again.
inline const DrivenMaps& round_trip() {
  static const DrivenMaps driven = drive(world("floor"), {{1.3, 1.2},
                                                          {15.0, 1.15},
                                                          {28.9, 1.2},
                                                          {28.9, 9.0},
                                                          {28.8, 18.7},
                                                          {15.0, 18.8},
                                                          {1.3, 18.8},
                                                          {1.3, 9.6},
                                                          {1.3, 1.2},
                                                          {11.0, 1.15}});
  return driven;
}

}  // namespace topogeo::localization::test
