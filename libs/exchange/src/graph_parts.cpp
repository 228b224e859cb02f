#include "graph_parts.hpp"

#include <numeric>

namespace topogeo::exchange {

GraphParts::GraphParts(std::span<const topomap::MapNode> nodes) : parents_(nodes.size()) {
  std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  for (std::size_t i = 0; i < nodes.size(); ++i) index_of_[nodes[i].id] = i;
}

bool GraphParts::join(const topomap::MapBranch& branch) {
  const std::size_t a = part(index_of_.at(branch.node_a));
  const std::size_t b = part(index_of_.at(branch.node_b));
  parents_[b] = a;
  return a != b;
}

std::size_t GraphParts::part(std::size_t node) {
  while (parents_[node] != node) {
    parents_[node] = parents_[parents_[node]];
    node = parents_[node];
  }
  return node;
}

}  // namespace topogeo::exchange
