// Selects the stops that a closed loop can move, so that the cost of least squares follows the loop
// and not the size of the map (docs/algorithms.md, "Pose graph").
//
// The window grows from the ends of the loops along the paths of least variance, which yield last,
// until it contains the round of every loop, and half as far again. The stops next to it are held.
// If a stop beside a held one moves noticeably (GraphSolution::strained), the next window is
// larger. The trade-off: a map with a long loop just closed stays bent for some stops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "topogeo/slam/graph_optimization.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

/// The stops that a loop connects.
struct LoopEnds {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

/// All stops, the first one held; `loops` are not part of the graph yet.
GraphProblem whole_problem(const PoseGraph& graph, std::span<const PoseGraphEdge> loops);

/// The stops around `fresh` loops and the last stop, at least `least_stops` of them. `loops` are
/// not part of the graph yet and count as fresh. All stops if the window exceeds half of them.
GraphProblem window_problem(const PoseGraph& graph, std::span<const PoseGraphEdge> loops,
                            std::span<const LoopEnds> fresh, std::size_t least_stops);

}  // namespace topogeo::localization
