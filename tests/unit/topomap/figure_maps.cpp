#include "figure_maps.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "well_formed.hpp"

namespace topogeo::figure_scenes {
namespace {

std::string kind_name(topomap::NodeKind kind) {
  switch (kind) {
    case topomap::NodeKind::kReal:
      return "real";
    case topomap::NodeKind::kFictitious:
      return "fictitious";
    case topomap::NodeKind::kVirtual:
      return "virtual";
    case topomap::NodeKind::kDoor:
      return "door";
    case topomap::NodeKind::kNarrowing:
      return "narrowing";
    case topomap::NodeKind::kHallCorridor:
      return "hall-corridor";
  }
  return "unknown";
}

}  // namespace

void expect_well_formed(const topomap::LocalMap& map, bool is_virtual) {
  topomap::test::expect_well_formed(map);
  for (const topomap::LocalNode& node : map.nodes) {
    EXPECT_EQ(node.kind == topomap::NodeKind::kVirtual, is_virtual);
  }
  for (const topomap::LocalBranch& branch : map.branches) EXPECT_EQ(branch.is_virtual, is_virtual);
}

MapSeen describe(const topomap::LocalMap& map, const std::vector<std::string>& group_names) {
  MapSeen seen;
  for (const topomap::LocalNode& node : map.nodes) {
    seen.nodes.push_back({kind_name(node.kind) + " " + joined_names(node.base_groups, group_names) +
                              (node.in_main_graph ? "" : " (off)"),
                          node.position_m, node.clearance_m});
  }
  for (const topomap::LocalBranch& branch : map.branches) {
    const auto end_name = [&](std::uint32_t id) {
      const topomap::LocalNode& node = map.nodes[id];
      return kind_name(node.kind) + " " + joined_names(node.base_groups, group_names);
    };
    std::array ends{end_name(branch.node_a), end_name(branch.node_b)};
    std::ranges::sort(ends, std::ranges::greater{});  // real before fictitious
    seen.branches.push_back(joined_names(branch.base_groups, group_names) + ": " + ends[0] + " - " +
                            ends[1] + (branch.in_main_graph ? "" : " (off)"));
  }
  std::ranges::sort(seen.branches);
  return seen;
}

Made make_map(const scan::Scan& scan, const voronoi::VoronoiConfig& config,
              const topomap::LocalMapConfig& map_config, const geometry::Pose2& T_robot_laser) {
  Made made;
  voronoi::LocalVoronoi voronoi(config);
  voronoi.compute(scan, made.diagram);
  topomap::build_local_map(made.diagram, scan, T_robot_laser, map_config, made.map);
  return made;
}

MapSeen see_map(const Scene& scene, const voronoi::VoronoiConfig& config,
                const topomap::LocalMapConfig& map_config, const simulation::BeamPattern& beams,
                std::size_t at) {
  const geometry::Pose2& T_world_laser = scene.T_world_laser.at(at);
  const Made made = make_map(scan_of(scene.world, T_world_laser, beams), config, map_config);
  return describe(made.map, group_names(made.diagram, scene.world, T_world_laser));
}

}  // namespace topogeo::figure_scenes
