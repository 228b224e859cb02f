// The cheapest path through a graph between any of several entries and any of several exits, by one
// run of Dijkstra's algorithm (Boost.Graph).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::planning {

/// An edge in both directions. Two nodes may have several.
struct GraphEdge {
  std::uint32_t node_a = 0;
  std::uint32_t node_b = 0;
  double cost = 0.0;  ///< finite, >= 0
};

/// A node where a path can begin or end, with the cost between it and the start or goal.
struct GraphAccess {
  std::uint32_t node = 0;
  double cost = 0.0;  ///< finite, >= 0
};

/// Closed parts, by index.
struct ClosedParts {
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> edges;
};

struct GraphPath {
  double cost = 0.0;                 ///< of the first access, the edges and the last access
  std::vector<std::uint32_t> nodes;  ///< >= 1
  std::vector<std::uint32_t> edges;  ///< one less than nodes
};

class RouteGraph {
 public:
  /// Nodes 0 to nodes - 1; edges are named by their index. Throws std::invalid_argument for an edge
  /// to a node that does not exist and for a cost out of range.
  RouteGraph(std::size_t nodes, std::span<const GraphEdge> edges);
  RouteGraph(RouteGraph&&) noexcept;
  RouteGraph& operator=(RouteGraph&&) noexcept;
  ~RouteGraph();

  /// The cheapest path from any entry to any exit, found by one search from all entries at once.
  /// Empty if none is connected. Throws std::invalid_argument for nodes and edges that do not
  /// exist.
  [[nodiscard]] std::optional<GraphPath> cheapest(std::span<const GraphAccess> entries,
                                                  std::span<const GraphAccess> exits,
                                                  const ClosedParts& closed = {}) const;

  /// Whether each node can be reached from an entry.
  [[nodiscard]] std::vector<bool> reached(std::span<const GraphAccess> entries,
                                          const ClosedParts& closed = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace topogeo::planning
