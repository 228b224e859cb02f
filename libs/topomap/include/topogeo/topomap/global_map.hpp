// The global topo-geometric map: all local maps fused in the map frame (Thesis, 7.3.2).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

struct MapNode {
  std::uint32_t id = 0;  ///< ascending in GlobalMap::nodes, possibly with gaps
  NodeKind kind = NodeKind::kReal;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  double clearance_m = 0.0;
  std::uint32_t observations = 1;  ///< number of views that saw it
  std::int64_t last_seen_ns = 0;   ///< stamp of the last view; 0: not known
};

struct MapBranch {
  std::uint32_t id = 0;      ///< ascending in GlobalMap::branches, possibly with gaps
  std::uint32_t node_a = 0;  ///< MapNode::id at points.front()
  std::uint32_t node_b = 0;  ///< MapNode::id at points.back()
  bool is_virtual = false;
  std::uint32_t observations = 1;
  std::vector<BranchPoint> points;  ///< map frame, ordered from node_a to node_b
  std::int64_t last_seen_ns = 0;    ///< as in MapNode; 0 for a virtual branch
};

struct GlobalMap {
  std::uint64_t version = 0;  ///< version of the trajectory it is based on
  std::vector<MapNode> nodes;
  std::vector<MapBranch> branches;
};

}  // namespace topogeo::topomap
