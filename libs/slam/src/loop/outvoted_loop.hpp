// Removes an accepted loop that the rest of the map contradicts.
#pragma once

#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

/// Whether the optimised poses contradict a loop; false for edges of other kinds. `T_map_robot` is
/// indexed by the ends of the edge.
bool is_outvoted(const PoseGraphEdge& edge, std::span<const geometry::Pose2> T_map_robot);

}  // namespace topogeo::localization
