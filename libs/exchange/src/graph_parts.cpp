#include "graph_parts.hpp"

#include <boost/pending/disjoint_sets.hpp>

namespace topogeo::exchange {
namespace {

using Sets = boost::disjoint_sets<std::size_t*, std::size_t*>;

}  // namespace

GraphParts::GraphParts(std::span<const topomap::MapNode> nodes)
    : ranks_(nodes.size(), 0), parents_(nodes.size(), 0) {
  Sets sets(ranks_.data(), parents_.data());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    sets.make_set(i);
    index_of_[nodes[i].id] = i;
  }
}

bool GraphParts::join(const topomap::MapBranch& branch) {
  Sets sets(ranks_.data(), parents_.data());
  const std::size_t a = sets.find_set(index_of_.at(branch.node_a));
  const std::size_t b = sets.find_set(index_of_.at(branch.node_b));
  if (a == b) return false;
  sets.link(a, b);
  return true;
}

std::size_t GraphParts::part(std::size_t node) {
  return Sets(ranks_.data(), parents_.data()).find_set(node);
}

}  // namespace topogeo::exchange
