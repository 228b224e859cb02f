// Shortest paths of a base that cannot turn on the spot, without obstacles: arcs of its smallest
// radius and straight lines, ahead and back.
//
// J. A. Reeds and L. A. Shepp: Optimal paths for a car that goes both forwards and backwards,
// Pacific Journal of Mathematics 145 (2), 1990: the words of sections 8.1 to 8.11.
#pragma once

#include <limits>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::planning {

struct ArcPiece {
  double length_m = 0.0;         ///< negative: back
  double curvature_per_m = 0.0;  ///< positive: turns left while it drives ahead
};
using ArcPath = std::vector<ArcPiece>;

/// The pose at the end of a piece.
geometry::Pose2 after(const geometry::Pose2& T_map_robot, const ArcPiece& piece);

/// All words that lead from one pose to another, in no order; `radius_m` > 0. Never empty for two
/// different poses.
std::vector<ArcPath> arc_paths(const geometry::Pose2& from, const geometry::Pose2& to,
                               double radius_m);

/// Length of the shortest of them, metres.
double shortest_arcs_m(const geometry::Pose2& from, const geometry::Pose2& to, double radius_m);

}  // namespace topogeo::planning
