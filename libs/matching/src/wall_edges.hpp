// Edges of walls in a scan: steps between parallel lines through the points on both sides.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

/// Edges that stand out from the noise: steps of 0.045 to 0.5 m, four deviations high, with 0.12 to
/// 0.45 m of wall on each side. `points_m`: successive points of one scan, shape n, in any frame in
/// which the laser is at `laser_m`; metres. Empty without such steps.
std::vector<WallEdge> find_wall_edges(const std::vector<Eigen::Vector2d>& points_m,
                                      const Eigen::Vector2d& laser_m);

}  // namespace topogeo::localization
