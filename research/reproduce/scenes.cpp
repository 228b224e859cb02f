#include "reproduce/scenes.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/simulation/laser.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

#include "reproduce/worlds.hpp"

namespace topogeo::reproduce {

scan::Scan exact_scan(const world::World& world, const geometry::Pose2& T_world_laser) {
  const simulation::BeamPattern beams;
  scan::Scan scan;
  scan.angle_min_rad = beams.angle_min_rad;
  scan.angle_step_rad = beams.angle_step_rad;
  for (const double range_m : simulation::raycast(world, T_world_laser, beams)) {
    scan.ranges_m.push_back(std::isfinite(range_m) ? static_cast<float>(range_m)
                                                   : scan::Scan::kNoReturn);
  }
  return scan;
}

SeenScene see(const world::World& world, const geometry::Pose2& T_world_laser,
              const voronoi::VoronoiConfig& voronoi, const topomap::LocalMapConfig& local_map) {
  SeenScene seen{world, T_world_laser, exact_scan(world, T_world_laser), {}, {}};
  voronoi::LocalVoronoi maker(voronoi);
  maker.compute(seen.scan, seen.diagram);
  topomap::build_local_map(seen.diagram, seen.scan, {}, local_map, seen.map);
  return seen;
}

SeenScene see_scene(const std::string& number, const voronoi::VoronoiConfig& voronoi,
                    const topomap::LocalMapConfig& local_map, std::size_t place) {
  const world::World world = world_named("figure_" + number);
  const Eigen::Vector2d& at_m = world.tour_m.at(place);
  return see(world, {at_m.x(), at_m.y(), 0.0}, voronoi, local_map);
}

std::size_t count_nodes(const topomap::LocalMap& map, topomap::NodeKind kind) {
  return static_cast<std::size_t>(std::ranges::count(map.nodes, kind, &topomap::LocalNode::kind));
}

}  // namespace topogeo::reproduce
