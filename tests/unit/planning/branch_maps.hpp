// Topo-geometric maps drawn node by node.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "topogeo/topomap/global_map.hpp"

namespace topogeo::planning {

inline void add_map_node(topomap::GlobalMap& map, std::uint32_t id, double x_m, double y_m) {
  map.nodes.push_back({id, topomap::NodeKind::kReal, {x_m, y_m}, 1.0, 1});
}

/// A branch from node a to node b through the points between, all with the same clearance.
inline void add_map_branch(topomap::GlobalMap& map, std::uint32_t id, std::uint32_t a,
                           std::uint32_t b, const std::vector<Eigen::Vector2d>& between_m = {},
                           double clearance_m = 1.0) {
  const auto place = [&](std::uint32_t node) {
    return std::ranges::find(map.nodes, node, &topomap::MapNode::id)->position_m;
  };
  topomap::MapBranch branch;
  branch.id = id;
  branch.node_a = a;
  branch.node_b = b;
  branch.points.push_back({place(a), clearance_m});
  for (const Eigen::Vector2d& point_m : between_m) branch.points.push_back({point_m, clearance_m});
  branch.points.push_back({place(b), clearance_m});
  map.branches.push_back(branch);
}

}  // namespace topogeo::planning
