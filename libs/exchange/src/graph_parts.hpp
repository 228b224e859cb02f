// The parts of a graph that its branches leave apart: disjoint sets with halved paths (Tarjan and
// van Leeuwen, "Worst-case analysis of set union algorithms", 1984).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

class GraphParts {
 public:
  /// Each node is a part of its own.
  explicit GraphParts(std::span<const topomap::MapNode> nodes);

  /// Joins the parts of a branch's ends; false: they were one. The ends must be among the nodes.
  bool join(const topomap::MapBranch& branch);

  /// The number of the part of a node, by the node's position in the list.
  [[nodiscard]] std::size_t part(std::size_t node);

 private:
  std::map<std::uint32_t, std::size_t> index_of_;  // by MapNode::id
  std::vector<std::size_t> parents_;               // a part is the node that is its own parent
};

}  // namespace topogeo::exchange
