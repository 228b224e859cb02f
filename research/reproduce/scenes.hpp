// One scan of a scene, and its diagram and local map with the settings of the Thesis.
#pragma once

#include <cstddef>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/local_map_config.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::reproduce {

/// A noise-free scan of the laser of the Thesis: 361 beams over 180 degrees.
scan::Scan exact_scan(const world::World& world, const geometry::Pose2& T_world_laser);

struct SeenScene {
  world::World world;
  geometry::Pose2 T_world_laser;
  scan::Scan scan;
  voronoi::LocalVoronoiDiagram diagram;  ///< laser frame
  topomap::LocalMap map;                 ///< the laser is at the robot's origin
};

SeenScene see(const world::World& world, const geometry::Pose2& T_world_laser,
              const voronoi::VoronoiConfig& voronoi, const topomap::LocalMapConfig& local_map);
/// Scene of share/figures/figure_<number>.world.yaml seen from its k-th place, facing along x.
SeenScene see_scene(const std::string& number, const voronoi::VoronoiConfig& voronoi,
                    const topomap::LocalMapConfig& local_map, std::size_t place = 0);

/// Number of nodes of this kind in the map.
std::size_t count_nodes(const topomap::LocalMap& map, topomap::NodeKind kind);

}  // namespace topogeo::reproduce
