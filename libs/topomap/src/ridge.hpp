// The ridge of the votes: a graph of curves one cell wide along the best supported places.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/topomap/global_map_builder.hpp"

#include "vote_grid.hpp"

namespace topogeo::topomap {

/// A place on the ridge.
struct RidgePoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  double clearance_m = 0.0;
  double share = 0.0;            ///< share of the views that voted for it, [0, 1]
  std::uint32_t first_seen = 0;  ///< VoteGrid::Block::first_seen of its block
  std::uint32_t views = 0;
  std::int64_t last_seen_ns = 0;  ///< stamp of the last of these views
};

struct RidgeEdge {
  std::uint32_t a = 0;  ///< indices of RidgeGraph::nodes; equal for a loop
  std::uint32_t b = 0;
  std::vector<RidgePoint> points;  ///< between the two nodes, from a to b
};

struct RidgeGraph {
  std::vector<RidgePoint> nodes;  ///< junctions and ends
  std::vector<RidgeEdge> edges;
};

/// Thins the cells with enough votes to the ridge and traces it.
RidgeGraph trace_ridge(const VoteGrid& grid, const GlobalMapConfig& config);

}  // namespace topogeo::topomap
