// Places on the branches of the map.
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "topogeo/planning/route_planner.hpp"

namespace topogeo::planning {

/// A place on a branch: `along` of the distance from its point `segment` to the next one.
struct BranchPlace {
  std::size_t branch = 0;  ///< index in GlobalMap::branches
  std::size_t segment = 0;
  double along = 0.0;  ///< [0, 1]
  RoutePoint at;
  double distance_m = 0.0;  ///< from the point that was looked up
};

/// The nearest place to a point on the map, where the clearance is at least min_clearance_m or the
/// branch is virtual; of equally near ones the one on the branch of the lowest index. Empty when
/// there is none.
std::optional<BranchPlace> nearest_place(const topomap::GlobalMap& map,
                                         const Eigen::Vector2d& point_m, double min_clearance_m);

}  // namespace topogeo::planning
