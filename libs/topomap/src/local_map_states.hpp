// Doors, narrowings and hall-corridor passages along one branch (spec A2, thesis 5.2.2.1).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "topogeo/topomap/local_map_builder.hpp"

namespace topogeo::topomap {

struct BranchState {
  std::size_t point = 0;  ///< index along the branch, never its first or last
  NodeKind kind = NodeKind::kDoor;
};

/// The states of a branch in the order of its points. A minimum of the clearance, confirmed on both
/// sides (5.3, 5.4), is a door or a narrowing; a long level stretch that the clearance rises from
/// is a corridor, and the end of the stretch the passage to the hall. A maximum is no state.
std::vector<BranchState> find_branch_states(std::span<const BranchPoint> points,
                                            const LocalMapConfig& config);

}  // namespace topogeo::topomap
