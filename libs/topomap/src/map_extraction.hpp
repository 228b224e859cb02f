// Extracts the global map from the refined ridge and the fused nodes.
#pragma once

#include "topogeo/topomap/global_map_builder.hpp"

#include "branch_names.hpp"
#include "node_fusion.hpp"
#include "ridge.hpp"

namespace topogeo::topomap {

/// Nodes have the ids of the fused nodes at their place, branches the ids of their anchors.
/// Elements without either (free ends, junctions that no single view saw, new branches) are named
/// by the block of the grid at their place.
GlobalMap extract_map(const RidgeGraph& ridge, const NodeFusion& nodes, const BranchNames& names,
                      const GlobalMapConfig& config);

}  // namespace topogeo::topomap
