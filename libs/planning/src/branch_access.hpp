// Places on branches from which a start or goal beside them is reached in a straight line.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/route_planner.hpp"

#include "branch_rules.hpp"

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

/// A metre along a branch costs 1. A metre off the branches or on a virtual one costs so much that
/// routes have as few of them as can be, and are the shortest of these.
inline constexpr double kLastResort = 100.0;

struct BranchAccess {
  BranchPlace place;
  double cost = 0.0;    ///< of the line between the point and the place
  bool proved = false;  ///< the map shows that the line is free for the robot
};

/// Looks for places from which a point is reached.
class AccessFinder {
 public:
  enum class End { kStart, kGoal };

  /// All must outlive it. `space`: the grid of the map; null: there is none.
  AccessFinder(const topomap::GlobalMap& map, const PlanningConfig& config,
               const BranchRules& rules, const FreeSpace* space)
      : map_(map), config_(config), rules_(rules), space_(space) {}

  /// For each stretch of a branch that is open the cheapest place within config.max_snap_m. A line
  /// crosses nothing that fills the floor. It is proved where its cells are passable, or it stays
  /// in the circle of clearance of the place, with room for the robot at a goal on a grid. Lines
  /// that are not cost ten times as much.
  [[nodiscard]] std::vector<BranchAccess> of(const Eigen::Vector2d& point_m, End end) const;

 private:
  [[nodiscard]] bool open(const topomap::MapBranch& branch, std::size_t segment) const;
  [[nodiscard]] std::optional<BranchAccess> access(const BranchPlace& place,
                                                   const Eigen::Vector2d& point_m, End end) const;

  const topomap::GlobalMap& map_;
  const PlanningConfig& config_;
  const BranchRules& rules_;
  const FreeSpace* space_;
};

}  // namespace topogeo::planning
