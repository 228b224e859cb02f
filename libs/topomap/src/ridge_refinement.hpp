// Turns the raw ridge into a readable graph: drops outvoted branches, spurs and crumbs, merges
// neighbouring junctions, closes gaps.
#pragma once

#include "topogeo/topomap/global_map_builder.hpp"

#include "ridge.hpp"

namespace topogeo::topomap {

/// Length of the edge between its nodes, m.
double length_m(const RidgeGraph& graph, const RidgeEdge& edge);

/// The refined graph; every node has at least one edge.
RidgeGraph refine_ridge(RidgeGraph graph, const GlobalMapConfig& config);

}  // namespace topogeo::topomap
