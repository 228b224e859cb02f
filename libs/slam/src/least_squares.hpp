// Robust least squares over relative poses, in its own file because Ceres is slow to compile.
#pragma once

#include <cstdint>
#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

/// Moves the poses that are not held to the best agreement of the edges, whose stops are indices of
/// `poses`. Matches have a Cauchy loss, so that a wrong one bends the map a little instead of
/// folding it. Single-threaded, so that results repeat.
OptimizationSummary least_squares(std::span<geometry::Pose2> poses,
                                  std::span<const std::uint8_t> held,
                                  std::span<const PoseGraphEdge> edges);

}  // namespace topogeo::localization
