#include "crossings.hpp"

#include <algorithm>
#include <optional>

#include "cell_order.hpp"

namespace topogeo::planning {
namespace {

// A border crossing of a path.
struct Crossing {
  std::uint32_t node = 0;
  ZoneId into = kNoZone;
};

// The node of the border between two neighbouring cells of different zones.
std::optional<std::uint32_t> node_between(const HybridMap& map, const Cell& a, const Cell& b) {
  const ZoneId zone_a = map.zone_of(a);
  const ZoneId zone_b = map.zone_of(b);
  for (const std::uint32_t id : map.nodes_of(zone_a)) {
    const BorderNode& node = map.nodes()[id];
    const std::size_t side = node.zones[0] == zone_a ? 0 : 1;
    if (node.zones[1 - side] != zone_b) continue;
    if (has_cell(node.border[side], a) && has_cell(node.border[1 - side], b)) return id;
  }
  return std::nullopt;
}

// A diagonal step between zones crosses the border at one of the two cells beside it.
Cell beside(const HybridMap& map, const Cell& a, const Cell& b) {
  const Cell first{b.column, a.row};
  const Cell second{a.column, b.row};
  const ZoneId zone = map.zone_of(second);
  return zone == map.zone_of(a) || zone == map.zone_of(b) ? second : first;
}

// The crossings, in order.
std::vector<Crossing> crossings(const HybridMap& map, std::span<const Cell> cells) {
  std::vector<Crossing> found;
  const auto step = [&](const Cell& a, const Cell& b) {
    if (map.zone_of(a) == map.zone_of(b)) return;
    if (const auto node = node_between(map, a, b)) found.push_back({*node, map.zone_of(b)});
  };
  const Cell* before = nullptr;
  for (const Cell& cell : cells) {
    if (map.zone_of(cell) == kNoZone) continue;
    if (before != nullptr && map.zone_of(*before) != map.zone_of(cell)) {
      if (before->column != cell.column && before->row != cell.row) {
        const Cell between = beside(map, *before, cell);
        if (map.zone_of(between) != kNoZone) {
          step(*before, between);
          step(between, cell);
        }
      } else {
        step(*before, cell);
      }
    }
    before = &cell;
  }
  return found;
}

}  // namespace

std::optional<std::uint32_t> edge_between(const HybridMap& map, ZoneId zone, std::uint32_t a,
                                          std::uint32_t b) {
  const auto& edges = map.edges();
  auto edge = std::lower_bound(edges.begin(), edges.end(), zone,
                               [](const HybridEdge& e, ZoneId z) { return e.zone < z; });
  for (; edge != edges.end() && edge->zone == zone; ++edge) {
    if ((edge->node_a == a && edge->node_b == b) || (edge->node_a == b && edge->node_b == a)) {
      return edge->id;
    }
  }
  return std::nullopt;
}

NodesAndEdges nodes_and_edges(const HybridMap& map, std::span<const Cell> cells) {
  NodesAndEdges used;
  ZoneId zone = kNoZone;
  for (const Crossing& crossing : crossings(map, cells)) {
    if (used.nodes.empty()) {
      used.nodes.push_back(crossing.node);
    } else if (crossing.node != used.nodes.back()) {
      if (const auto edge = edge_between(map, zone, used.nodes.back(), crossing.node)) {
        used.edges.push_back(*edge);
      }
      used.nodes.push_back(crossing.node);
    }
    zone = crossing.into;
  }
  return used;
}

}  // namespace topogeo::planning
