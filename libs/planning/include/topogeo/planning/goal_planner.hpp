// Routes on all that is known of a floor: grid and zones (MACONDO, III.3), or nodes and branches
// (Thesis, 1.1; docs/algorithms.md, "Use of the map").
//
// One is asked first, the other where the first has no route: a map without a grid or an unfinished
// one, a door that noise on the grid has shut, a robot where nothing is known.
#pragma once

#include <span>

#include <Eigen/Core>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/planning_config.hpp"
#include "topogeo/planning/route_planner.hpp"

namespace topogeo::planning {

/// Either may be missing.
struct PlanningMaps {
  const HybridMap* hybrid = nullptr;
  const topomap::GlobalMap* graph = nullptr;

  /// Whether any has something to plan on: a zone or a branch.
  [[nodiscard]] bool any() const {
    return (hybrid != nullptr && !hybrid->zones().zones.empty()) ||
           (graph != nullptr && !graph->branches.empty());
  }
};

struct GoalPlannerConfig {
  PlannerConfig planner;
  HybridPlannerConfig hybrid;
  PlanningConfig graph;
};

/// A route from a point of the map frame. `filled_m` are points of what is not on the map. Parts of
/// the route say on what it was planned. When neither has one, what the hybrid planner says of it,
/// or without zones the other. Throws std::invalid_argument as `check` of the settings.
HybridRoute plan_to_goal(const PlanningMaps& maps, const Eigen::Vector2d& from_m, const Target& to,
                         std::span<const Eigen::Vector2d> filled_m = {},
                         const GoalPlannerConfig& config = {});

/// A route along branches as that of the planner on the grid: with the lines from the start to the
/// first branch and from the last to the goal, and without points that are as good as in line.
HybridRoute along_branches(const PlanResult& result, const Eigen::Vector2d& from_m,
                           const Eigen::Vector2d& to_m);

}  // namespace topogeo::planning
