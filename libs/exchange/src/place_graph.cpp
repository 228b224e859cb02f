#include "topogeo/exchange/place_graph.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::exchange {

void move(MapGraph& graph, const geometry::Pose2& T_map_graph) {
  if (T_map_graph == geometry::Pose2{}) return;  // keeps every bit
  for (topomap::MapNode& node : graph.map.nodes) node.position_m = T_map_graph * node.position_m;
  for (topomap::MapBranch& branch : graph.map.branches) {
    for (topomap::BranchPoint& p : branch.points) p.position_m = T_map_graph * p.position_m;
  }
  pipeline::move(graph.drawing, T_map_graph);
}

namespace {

bool has_no_clearance(const topomap::MapNode& node) {
  return node.clearance_m == 0.0;
}

}  // namespace

bool lacks_clearance(const topomap::MapBranch& branch) {
  return std::ranges::all_of(branch.points,
                             [](const topomap::BranchPoint& p) { return p.clearance_m == 0.0; });
}

bool lacks_clearances(const topomap::GlobalMap& map) {
  return std::ranges::any_of(map.nodes, has_no_clearance) ||
         std::ranges::any_of(map.branches, lacks_clearance);
}

void take_clearances(topomap::GlobalMap& map, const planning::FreeSpace& space) {
  const auto at = [&](const Eigen::Vector2d& position_m) {
    const auto cell = space.frame().cell_of(position_m);
    const double clearance_m = cell ? space.clearance_m(*cell) : 0.0;
    return std::isfinite(clearance_m) ? clearance_m : 0.0;
  };
  for (topomap::MapNode& node : map.nodes) {
    if (has_no_clearance(node)) node.clearance_m = at(node.position_m);
  }
  for (topomap::MapBranch& branch : map.branches) {
    if (!lacks_clearance(branch)) continue;
    for (topomap::BranchPoint& p : branch.points) p.clearance_m = at(p.position_m);
  }
}

void lay_over(storage::MapDocument& document, MapGraph graph, Notes& notes) {
  pipeline::lay_over(document.drawing, std::move(graph.drawing));
  if (graph.map.nodes.empty()) return;
  // Without stops the nodes were made of a grid, or came from another file.
  if (document.global_map.nodes.empty() || document.local_maps.empty()) {
    if (!document.global_map.nodes.empty()) {
      notes.push_back(
          fmt::format("{} nodes and {} branches of the map are replaced: it has no stops",
                      document.global_map.nodes.size(), document.global_map.branches.size()));
    }
    // A map must not be newer than the trajectory that it was made from.
    document.trajectory.version = std::max(document.trajectory.version, graph.map.version);
    document.global_map = std::move(graph.map);
    return;
  }
  notes.push_back(
      fmt::format("{} nodes and {} branches left out: the map has nodes of its own stops",
                  graph.map.nodes.size(), graph.map.branches.size()));
}

}  // namespace topogeo::exchange
