// Makes the global map of the refined ridge and the fused nodes.
#pragma once

#include "topogeo/topomap/global_map_builder.hpp"

#include "branch_names.hpp"
#include "node_fusion.hpp"
#include "ridge.hpp"

namespace topogeo::topomap {

/// Ids of nodes are those of the fused nodes that lie there, ids of branches those of their
/// anchors; what has neither (free ends, junctions that no single view saw, branches just found) is
/// named by the block of the grid where it lies.
GlobalMap extract_map(const RidgeGraph& ridge, const NodeFusion& nodes, const BranchNames& names,
                      const GlobalMapConfig& config);

}  // namespace topogeo::topomap
