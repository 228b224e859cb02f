#include "graph_checks.hpp"

#include <algorithm>
#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::exchange {
namespace {

template <typename Element>
void sort_by_id(std::vector<Element>& elements, const std::string& name, const char* what) {
  std::ranges::stable_sort(elements, {}, &Element::id);
  const auto repeated = std::ranges::adjacent_find(elements, {}, &Element::id);
  if (repeated == elements.end()) return;
  throw std::runtime_error(
      fmt::format("{}: {} {}: expected each id once", name, what, repeated->id));
}

}  // namespace

void settle(MapGraph& graph, const std::string& name) {
  sort_by_id(graph.map.nodes, name, "node");
  sort_by_id(graph.map.branches, name, "branch");
  for (const topomap::MapBranch& branch : graph.map.branches) {
    for (const std::uint32_t id : {branch.node_a, branch.node_b}) {
      if (std::ranges::binary_search(graph.map.nodes, id, {}, &topomap::MapNode::id)) continue;
      throw std::runtime_error(
          fmt::format("{}: branch {} ends at node {}, which does not exist", name, branch.id, id));
    }
  }
  try {
    storage::check(graph.drawing);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

}  // namespace topogeo::exchange
