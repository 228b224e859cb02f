// Which border nodes and edges of the hybrid map a way over cells uses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/planning/hybrid_map.hpp"

namespace topogeo::planning {

/// A border that a way crosses, wherever on its length.
struct Crossing {
  std::uint32_t node = 0;
  ZoneId into = kNoZone;
};

/// In order. `cells` are neighbours each; those in no zone are skipped.
std::vector<Crossing> crossings(const HybridMap& map, std::span<const Cell> cells);

/// Nodes and edges of crossings, as in HybridRoute.
struct NodesAndEdges {
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> edges;
};
NodesAndEdges nodes_and_edges(const HybridMap& map, std::span<const Crossing> crossings);

}  // namespace topogeo::planning
