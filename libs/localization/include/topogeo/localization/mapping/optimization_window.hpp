// Which stops a closed loop can move: least squares over them alone cost what the loop is worth,
// not what the map has (docs/algorithms.md, "Pose graph").
//
// The window grows from the ends of the loops along the paths of least variance, which give way
// last, until it holds the round that each of them closes, and half as far again. The stops next to
// it are held. Where one beside them wants to move all the same (GraphSolution::strained) the next
// window is larger: the trade-off is that a map with a long loop just closed is bent for some
// stops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "topogeo/localization/mapping/graph_optimization.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"

namespace topogeo::localization {

/// The stops that a loop connects.
struct LoopEnds {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

/// All stops, the first held; `loops` are not part of the graph yet.
GraphProblem whole_problem(const PoseGraph& graph, std::span<const PoseGraphEdge> loops);

/// The stops around `fresh` loops and the last stop, at least `least_stops` of them. `loops` are
/// not part of the graph yet and count as fresh. More than half of the stops: all of them.
GraphProblem window_problem(const PoseGraph& graph, std::span<const PoseGraphEdge> loops,
                            std::span<const LoopEnds> fresh, std::size_t least_stops);

}  // namespace topogeo::localization
