// A search window as a graph of Boost.Graph. A vertex is the index of a cell in the window; edges
// lead to the open neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include <boost/graph/graph_traits.hpp>
#include <boost/iterator/iterator_facade.hpp>

#include "topogeo/planning/grid_search.hpp"

namespace topogeo::planning {

struct CellEdge {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  bool diagonal = false;

  friend bool operator==(const CellEdge&, const CellEdge&) = default;
};

/// Bit k of a mask is neighbour k: 0 to 3 straight (east, north, west, south), 4 to 7 diagonal
/// (north-east, north-west, south-west, south-east).
class CellGraph {
 public:
  explicit CellGraph(const SearchWindow& window)
      : mask_(window.mask().data()),
        directions_(window.directions().empty() ? nullptr : window.directions().data()) {
    const auto up = static_cast<std::int32_t>(window.stride());
    offsets_ = {1, up, -1, -up, up + 1, up - 1, -up - 1, -up + 1};
  }

  [[nodiscard]] std::uint32_t neighbours(std::uint32_t vertex) const {
    const auto open = [&](std::size_t k) { return mask_[neighbour(vertex, k)] != 0; };
    const bool east = open(0);
    const bool north = open(1);
    const bool west = open(2);
    const bool south = open(3);
    const bool north_east = north && east && open(4);
    const bool north_west = north && west && open(5);
    const bool south_west = south && west && open(6);
    const bool south_east = south && east && open(7);
    const std::uint32_t open_ones =
        static_cast<std::uint32_t>(east) | static_cast<std::uint32_t>(north) << 1U |
        static_cast<std::uint32_t>(west) << 2U | static_cast<std::uint32_t>(south) << 3U |
        static_cast<std::uint32_t>(north_east) << 4U |
        static_cast<std::uint32_t>(north_west) << 5U |
        static_cast<std::uint32_t>(south_west) << 6U | static_cast<std::uint32_t>(south_east) << 7U;
    return directions_ == nullptr ? open_ones : allowed(vertex, open_ones);
  }

  [[nodiscard]] std::uint32_t neighbour(std::uint32_t vertex, std::size_t k) const {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(vertex) + offsets_[k]);
  }

 private:
  [[nodiscard]] std::uint32_t allowed(std::uint32_t vertex, std::uint32_t neighbours) const {
    std::uint32_t kept = neighbours & directions_[vertex];
    for (std::uint32_t left = kept; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(__builtin_ctz(left));
      kept &= ~(1U << k) | directions_[neighbour(vertex, k)];
    }
    return kept;
  }

  const std::uint8_t* mask_;
  const std::uint8_t* directions_;  // null: all allowed
  std::array<std::int32_t, 8> offsets_{};
};

class CellEdgeIterator : public boost::iterator_facade<CellEdgeIterator, CellEdge,
                                                       boost::forward_traversal_tag, CellEdge> {
 public:
  CellEdgeIterator() = default;
  CellEdgeIterator(const CellGraph& graph, std::uint32_t vertex, std::uint32_t left)
      : graph_(&graph), vertex_(vertex), left_(left) {}

 private:
  friend class boost::iterator_core_access;

  [[nodiscard]] CellEdge dereference() const {
    const auto k = static_cast<std::size_t>(__builtin_ctz(left_));
    return {vertex_, graph_->neighbour(vertex_, k), k >= 4};
  }
  void increment() { left_ &= left_ - 1; }
  [[nodiscard]] bool equal(const CellEdgeIterator& other) const { return left_ == other.left_; }

  const CellGraph* graph_ = nullptr;
  std::uint32_t vertex_ = 0;
  std::uint32_t left_ = 0;
};

inline std::pair<CellEdgeIterator, CellEdgeIterator> out_edges(std::uint32_t vertex,
                                                               const CellGraph& graph) {
  return {CellEdgeIterator(graph, vertex, graph.neighbours(vertex)),
          CellEdgeIterator(graph, vertex, 0)};
}
inline std::uint32_t source(const CellEdge& edge, const CellGraph& /*graph*/) {
  return edge.from;
}
inline std::uint32_t target(const CellEdge& edge, const CellGraph& /*graph*/) {
  return edge.to;
}
inline std::uint32_t out_degree(std::uint32_t vertex, const CellGraph& graph) {
  return static_cast<std::uint32_t>(__builtin_popcount(graph.neighbours(vertex)));
}

}  // namespace topogeo::planning

template <>
struct boost::graph_traits<topogeo::planning::CellGraph> {
  using vertex_descriptor = std::uint32_t;
  using edge_descriptor = topogeo::planning::CellEdge;
  using out_edge_iterator = topogeo::planning::CellEdgeIterator;
  using degree_size_type = std::uint32_t;
  using directed_category = boost::directed_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  using traversal_category = boost::incidence_graph_tag;
  static std::uint32_t null_vertex() { return 0; }  // this corner of the window's rim is closed
};
