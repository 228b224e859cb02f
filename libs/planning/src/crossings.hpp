// Border nodes and edges of the hybrid map that a path over cells uses.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/hybrid_map.hpp"

namespace topogeo::planning {

/// Same meaning as in HybridRoute.
struct NodesAndEdges {
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> edges;
};

/// The borders that a path crosses, at any place, and the edges between them. `cells` are
/// connected; cells without a zone are skipped.
NodesAndEdges nodes_and_edges(const HybridMap& map, std::span<const Cell> cells);

/// HybridEdge::id of the edge that joins two nodes within a zone; nothing without one.
std::optional<std::uint32_t> edge_between(const HybridMap& map, ZoneId zone, std::uint32_t a,
                                          std::uint32_t b);

}  // namespace topogeo::planning
