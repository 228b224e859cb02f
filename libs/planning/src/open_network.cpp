#include "open_network.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "cell_order.hpp"
#include "crossings.hpp"

namespace topogeo::planning {
namespace {

constexpr std::uint32_t kNoPart = std::numeric_limits<std::uint32_t>::max();

bool contains(const std::vector<std::uint32_t>& numbers, std::uint32_t number) {
  return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

std::int64_t squared(const Cell& a, const Cell& b) {
  const std::int64_t across = a.column - b.column;
  const std::int64_t up = a.row - b.row;
  return across * across + up * up;
}

std::size_t index_in(const CellBox& box, const Cell& cell) {
  const auto width = static_cast<std::size_t>(box.high.column - box.low.column) + 1;
  return static_cast<std::size_t>(cell.row - box.low.row) * width +
         static_cast<std::size_t>(cell.column - box.low.column);
}

std::array<Cell, 4> neighbours_of(const Cell& cell) {
  return {Cell{cell.column + 1, cell.row}, Cell{cell.column, cell.row + 1},
          Cell{cell.column - 1, cell.row}, Cell{cell.column, cell.row - 1}};
}

}  // namespace

OpenNetwork::Link OpenNetwork::link_of(const HybridEdge& edge) {
  return {edge.node_a, edge.node_b, edge.id, &edge.route, edge.cost_m};
}

OpenNetwork::OpenNetwork(const HybridMap& map, const ClosedParts& closed, const ClosedCells& cells)
    : map_(map), closed_(closed), cells_(cells) {
  if (cells.empty()) return;
  find_parts();
  find_nodes();
  find_links();
}

const std::vector<std::uint32_t>& OpenNetwork::nodes_of(ZoneId zone) const {
  return graph_ ? nodes_of_[zone] : map_.nodes_of(zone);
}

const Cell& OpenNetwork::cell_in(std::uint32_t node, ZoneId zone) const {
  if (!graph_) return map_.nodes()[node].cell_in(zone);
  return place_in(nodes_[node], zone);
}

const Cell& OpenNetwork::place_in(const Node& node, ZoneId zone) const {
  return node.cells[map_.nodes()[node.border_node].zones[0] == zone ? 0 : 1];
}

std::optional<GraphPath> OpenNetwork::cheapest(std::span<const GraphAccess> entries,
                                               std::span<const GraphAccess> exits) const {
  // A separate network contains no closed parts.
  return graph_ ? graph_->cheapest(entries, exits) : map_.graph().cheapest(entries, exits, closed_);
}

std::uint32_t OpenNetwork::border_node(std::uint32_t node) const {
  return graph_ ? nodes_[node].border_node : node;
}

OpenNetwork::Link OpenNetwork::link(std::uint32_t edge) const {
  if (graph_) return links_[edge];
  return link_of(map_.edges()[edge]);
}

std::vector<bool> OpenNetwork::within_reach(const Cell& from) const {
  const ZoneId home = map_.zone_of(from);
  std::vector<GraphAccess> entries;
  for (const std::uint32_t node : nodes_of(home)) {
    if (part_of(home, cell_in(node, home)) == part_of(home, from)) entries.push_back({node, 0.0});
  }
  const std::vector<bool> nodes =
      graph_ ? graph_->reached(entries) : map_.graph().reached(entries, closed_);
  std::vector<std::vector<bool>> reached(map_.zones().zones.size());
  for (const Zone& zone : map_.zones().zones) {
    const auto parts = parts_.find(zone.id);
    reached[zone.id].resize(parts == parts_.end() ? 1 : parts->second.count, false);
    for (const std::uint32_t node : nodes_of(zone.id)) {
      if (nodes[node]) reached[zone.id][part_of(zone.id, cell_in(node, zone.id))] = true;
    }
  }
  reached[home][part_of(home, from)] = true;
  std::vector<bool> result(map_.frame().size(), false);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const ZoneId zone = map_.zones().zone_of_cell[i];
    if (zone == kNoZone) continue;
    const std::uint32_t part = part_of(zone, map_.frame().cell_at(i));
    result[i] = part != kNoPart && reached[zone][part];
  }
  return result;
}

std::uint32_t OpenNetwork::part_of(ZoneId zone, const Cell& cell) const {
  const auto parts = parts_.find(zone);
  if (parts == parts_.end()) return 0;
  return parts->second.part[index_in(parts->second.box, cell)];
}

void OpenNetwork::find_parts() {
  for (const Cell& cell : cells_.forbidden()) parts_.try_emplace(map_.zone_of(cell));
  for (auto& [zone, parts] : parts_) {
    parts.box = map_.zones().zones[zone].box;
    SearchWindow open(map_.frame(), parts.box, map_.zones().zone_of_cell, zone);
    cells_.close_in(open);
    const Cell& high = parts.box.high;
    parts.part.assign(index_in(parts.box, high) + 1, kNoPart);
    std::vector<Cell> edge;
    const auto reach = [&, &parts = parts](const Cell& cell) {
      if (!open.open(cell) || parts.part[index_in(parts.box, cell)] != kNoPart) return;
      parts.part[index_in(parts.box, cell)] = parts.count;
      edge.push_back(cell);
    };
    for (std::int32_t row = parts.box.low.row; row <= high.row; ++row) {
      for (std::int32_t column = parts.box.low.column; column <= high.column; ++column) {
        reach({column, row});
        if (edge.empty()) continue;
        while (!edge.empty()) {
          const Cell cell = edge.back();
          edge.pop_back();
          for (const Cell& next : neighbours_of(cell)) reach(next);
        }
        ++parts.count;
      }
    }
  }
}

void OpenNetwork::find_nodes() {
  for (const BorderNode& border : map_.nodes()) nodes_.push_back({border.id, border.cells, false});
  nodes_of_.resize(map_.zones().zones.size());
  for (const BorderNode& border : map_.nodes()) {
    if (contains(closed_.nodes, border.id)) continue;
    if (parts_.contains(border.zones[0]) || parts_.contains(border.zones[1])) {
      place_node(border);
      continue;
    }
    for (const ZoneId zone : border.zones) nodes_of_[zone].push_back(border.id);
  }
}

// Makes a node for each pair of parts that open places of the border join.
void OpenNetwork::place_node(const BorderNode& border) {
  using PartPair = std::pair<std::uint32_t, std::uint32_t>;
  std::map<PartPair, std::array<Cell, 2>> places;
  const auto off_middle = [&](const std::array<Cell, 2>& cells) {
    return squared(cells[0], border.cells[0]) + squared(cells[1], border.cells[1]);
  };
  for (const Cell& near : border.border[0]) {
    if (cells_.forbids(near)) continue;
    for (const Cell& far : neighbours_of(near)) {
      if (map_.zone_of(far) != border.zones[1] || cells_.forbids(far)) continue;
      const PartPair parts{part_of(border.zones[0], near), part_of(border.zones[1], far)};
      const std::array<Cell, 2> cells{near, far};
      const auto [place, is_new] = places.try_emplace(parts, cells);
      if (!is_new && off_middle(cells) < off_middle(place->second)) place->second = cells;
    }
  }
  bool first = true;
  for (const auto& [parts, cells] : places) {
    const auto number = first ? border.id : static_cast<std::uint32_t>(nodes_.size());
    const Node node{border.id, cells, !first || cells != border.cells};
    if (first) {
      nodes_[number] = node;
    } else {
      nodes_.push_back(node);
    }
    first = false;
    for (const ZoneId zone : border.zones) nodes_of_[zone].push_back(number);
  }
}

// A diagonal step passes between two cells that must also be open.
bool OpenNetwork::blocks(const std::vector<Cell>& route) const {
  for (std::size_t i = 0; i < route.size(); ++i) {
    if (cells_.forbids(route[i])) return true;
    if (i == 0) continue;
    if (cells_.forbids({route[i].column, route[i - 1].row})) return true;
    if (cells_.forbids({route[i - 1].column, route[i].row})) return true;
  }
  return false;
}

void OpenNetwork::find_links() {
  std::vector<bool> anew(map_.zones().zones.size(), false);
  for (const auto& [zone, parts] : parts_) anew[zone] = true;
  for (const Node& node : nodes_) {
    if (!node.moved) continue;
    for (const ZoneId zone : map_.nodes()[node.border_node].zones) anew[zone] = true;
  }
  for (const HybridEdge& edge : map_.edges()) {
    if (anew[edge.zone] || contains(closed_.edges, edge.id) ||
        contains(closed_.nodes, edge.node_a) || contains(closed_.nodes, edge.node_b)) {
      continue;
    }
    links_.push_back(link_of(edge));
  }
  for (const Zone& zone : map_.zones().zones) {
    if (anew[zone.id]) search_zone(zone.id);
  }
  std::vector<GraphEdge> edges;
  edges.reserve(links_.size());
  for (const Link& link : links_) edges.push_back({link.node_a, link.node_b, link.cost_m});
  graph_.emplace(nodes_.size(), edges);
}

void OpenNetwork::search_zone(ZoneId zone) {
  SearchWindow window(map_.frame(), map_.zones().zones[zone].box, map_.zones().zone_of_cell, zone);
  cells_.close_in(window);
  const std::vector<std::uint32_t>& nodes = nodes_of_[zone];
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& from = nodes_[nodes[i]];
    std::vector<Link> wanted;
    std::vector<Cell> ends;
    for (std::size_t k = i + 1; k < nodes.size(); ++k) {
      const Node& to = nodes_[nodes[k]];
      const auto known = edge_between(map_, zone, from.border_node, to.border_node);
      if (known) {
        if (contains(closed_.edges, *known)) continue;
        // Closed cells make no path shorter, so an unaffected path remains the best.
        const HybridEdge& edge = map_.edges()[*known];
        if (!from.moved && !to.moved && !blocks(edge.route)) {
          links_.push_back(link_of(edge));
          continue;
        }
      }
      wanted.push_back({nodes[i], nodes[k], known});
      ends.push_back(place_in(to, zone));
    }
    if (wanted.empty()) continue;
    auto paths = shortest_paths(window, place_in(from, zone), ends);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (!paths[k]) continue;
      wanted[k].cost_m = (paths[k]->cost_cells + 1.0) * map_.frame().resolution_m;
      wanted[k].route = &routes_.emplace_back(std::move(paths[k]->cells));
      links_.push_back(wanted[k]);
    }
  }
}

}  // namespace topogeo::planning
