// Places on branches that are connected to a start or goal by a straight line.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/route_planner.hpp"

#include "branch_rules.hpp"

namespace topogeo::planning {

/// A place on a branch: the fraction `along` between its point `segment` and the next one.
struct BranchPlace {
  std::size_t branch = 0;  ///< index in GlobalMap::branches
  std::size_t segment = 0;
  double along = 0.0;  ///< [0, 1]
  RoutePoint at;
  double distance_m = 0.0;  ///< from the given point
};

/// The nearest place on the map to a point, where the clearance is at least min_clearance_m or the
/// branch is virtual; the lowest branch index breaks ties. Empty if there is none.
std::optional<BranchPlace> nearest_place(const topomap::GlobalMap& map,
                                         const Eigen::Vector2d& point_m, double min_clearance_m);

/// A metre along a branch costs 1. A metre off the branches or on a virtual one costs this much, so
/// that routes have as few of them as possible, and are shortest among these.
inline constexpr double kLastResort = 100.0;

struct BranchAccess {
  BranchPlace place;
  double cost = 0.0;    ///< of the line between the point and the place
  bool proved = false;  ///< the map shows that the line is free for the robot
};

/// Finds the places from which a point is reached.
class AccessFinder {
 public:
  enum class End { kStart, kGoal };

  /// All must outlive it. `space`: the grid of the map; null: there is none.
  AccessFinder(const topomap::GlobalMap& map, const PlanningConfig& config,
               const BranchRules& rules, const FreeSpace* space)
      : map_(map), config_(config), rules_(rules), space_(space) {}

  /// The cheapest place within config.max_snap_m on each open part of a branch. Lines do not cross
  /// present obstacles. A line is proved if its cells are passable, or if it stays in the place's
  /// circle of clearance, with room for the robot at a goal on a grid. Unproved lines cost ten
  /// times as much.
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
