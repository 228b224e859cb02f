// The hybrid representation of MACONDO, III.2 (docs/algorithms.md, "Hybrid map and planner"): grid,
// zones, and a graph whose nodes are the middles of the borders between zones and whose edges join
// the nodes of a zone, with cost and route from the grid.
//
// Building takes one search through each of its two zones for every node: with z zones of c cells
// and k nodes each, z k searches of c cells. `plan/build_2000` measures it. Only the source of a
// map (grid, drawing or topo-geometric map) is stored; the map is rebuilt from it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/route_graph.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// The middle of a border: two cells side by side, one in each zone.
struct BorderNode {
  std::uint32_t id = 0;                                  ///< index in HybridMap::nodes
  std::array<ZoneId, 2> zones{};                         ///< ascending
  std::array<Cell, 2> cells{};                           ///< cells[i] is in zones[i]
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< between the two, map frame
  double clearance_m = 0.0;                              ///< the smaller of the two
  /// Border cells on either side, row by row; closed when the border cannot be passed.
  std::array<std::vector<Cell>, 2> border;

  /// Its cell in one of its two zones.
  [[nodiscard]] const Cell& cell_in(ZoneId zone) const {
    return zone == zones[0] ? cells[0] : cells[1];
  }
};

/// The path between two nodes of a zone.
struct HybridEdge {
  std::uint32_t id = 0;  ///< index in HybridMap::edges
  std::uint32_t node_a = 0;
  std::uint32_t node_b = 0;
  ZoneId zone = 0;
  double cost_m = 0.0;      ///< between the positions of the nodes, along the route
  std::vector<Cell> route;  ///< from node_a's cell in the zone to node_b's
};

class HybridMap {
 public:
  /// Builds nodes and edges. Throws std::invalid_argument if the zones do not belong to this space
  /// (see zones.hpp), and for places without a name or with a repeated one.
  HybridMap(FreeSpace space, ZoneMap zones, std::vector<Place> places = {});

  [[nodiscard]] const FreeSpace& space() const { return space_; }
  [[nodiscard]] const GridFrame& frame() const { return space_.frame(); }
  [[nodiscard]] const ZoneMap& zones() const { return zones_; }
  [[nodiscard]] const std::vector<BorderNode>& nodes() const { return nodes_; }
  /// Sorted by zone, ascending.
  [[nodiscard]] const std::vector<HybridEdge>& edges() const { return edges_; }
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }
  [[nodiscard]] const RouteGraph& graph() const { return graph_; }

  /// Nodes on the borders of a zone, ascending.
  [[nodiscard]] const std::vector<std::uint32_t>& nodes_of(ZoneId zone) const {
    return nodes_of_zone_[zone];
  }

  /// kNoZone outside and for impassable cells.
  [[nodiscard]] ZoneId zone_of(const Cell& cell) const {
    return frame().contains(cell) ? zones_.zone_of_cell[frame().index(cell)] : kNoZone;
  }

 private:
  void find_nodes();
  void find_edges();

  FreeSpace space_;
  ZoneMap zones_;
  std::vector<Place> places_;
  std::vector<BorderNode> nodes_;
  std::vector<HybridEdge> edges_;
  std::vector<std::vector<std::uint32_t>> nodes_of_zone_;
  RouteGraph graph_;
};

}  // namespace topogeo::planning
