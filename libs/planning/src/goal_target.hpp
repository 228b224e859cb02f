// Resolves a goal to a point.
#pragma once

#include <Eigen/Core>

#include "topogeo/planning/hybrid_planner.hpp"

namespace topogeo::planning {

struct GoalTarget {
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
  HybridRoute failure;  ///< if the goal is unknown
  bool known = true;
};

/// `map` null: there is none, so only points are known.
GoalTarget resolve(const HybridMap* map, const Target& to);

}  // namespace topogeo::planning
