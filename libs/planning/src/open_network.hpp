// The open part of the hybrid map's graph.
//
// If no cell is closed, it is the graph of the map. Closed cells can cut a zone into parts and shut
// a border in places: then a node represents the open places of a border between the same two
// parts, at the one nearest to its middle, and affected paths are searched again.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/route_graph.hpp"

#include "closed_cells.hpp"

namespace topogeo::planning {

class OpenNetwork {
 public:
  /// `closed` are nodes and edges of the map. All arguments must outlive it.
  OpenNetwork(const HybridMap& map, const ClosedParts& closed, const ClosedCells& cells);

  /// Nodes of the network on the borders of a zone.
  [[nodiscard]] const std::vector<std::uint32_t>& nodes_of(ZoneId zone) const;

  /// The cell of a node of the network in a zone that it borders on.
  [[nodiscard]] const Cell& cell_in(std::uint32_t node, ZoneId zone) const;

  /// The cheapest path between nodes of the network, like RouteGraph::cheapest.
  [[nodiscard]] std::optional<GraphPath> cheapest(std::span<const GraphAccess> entries,
                                                  std::span<const GraphAccess> exits) const;

  /// BorderNode::id of a node of the network.
  [[nodiscard]] std::uint32_t border_node(std::uint32_t node) const;

  /// An edge of the network.
  struct Link {
    std::uint32_t node_a = 0;
    std::uint32_t node_b = 0;
    std::optional<std::uint32_t> edge;  ///< HybridEdge::id; none between places of one border
    const std::vector<Cell>* route = nullptr;  ///< from node_a's cell to node_b's
    double cost_m = 0.0;
  };
  [[nodiscard]] Link link(std::uint32_t edge) const;

  /// For each cell of the grid, by index, whether a robot can reach it from an open cell.
  [[nodiscard]] std::vector<bool> within_reach(const Cell& from) const;

 private:
  // The parts of a zone: a label for each cell of its box.
  struct Parts {
    CellBox box;
    std::vector<std::uint32_t> part;
    std::uint32_t count = 0;
  };
  struct Node {
    std::uint32_t border_node = 0;
    std::array<Cell, 2> cells{};  // like BorderNode::cells
    bool moved = false;           // they differ from those of the border node
  };

  [[nodiscard]] static Link link_of(const HybridEdge& edge);
  [[nodiscard]] const Cell& place_in(const Node& node, ZoneId zone) const;
  void find_parts();
  void find_nodes();
  void place_node(const BorderNode& border);
  void find_links();
  void search_zone(ZoneId zone);
  [[nodiscard]] bool blocks(const std::vector<Cell>& route) const;
  [[nodiscard]] std::uint32_t part_of(ZoneId zone, const Cell& cell) const;

  const HybridMap& map_;
  const ClosedParts& closed_;
  const ClosedCells& cells_;
  // Used only if cells are closed.
  std::map<ZoneId, Parts> parts_;  // of zones with closed cells
  std::vector<Node> nodes_;        // the first ones share the numbers of their border nodes
  std::vector<std::vector<std::uint32_t>> nodes_of_;
  std::vector<Link> links_;
  std::deque<std::vector<Cell>> routes_;  // of links that were searched again
  std::optional<RouteGraph> graph_;
};

}  // namespace topogeo::planning
