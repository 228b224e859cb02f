// Plans routes on all available maps of a floor: grid and zones (MACONDO, III.3), or nodes and
// branches (Thesis, 1.1; docs/algorithms.md, "Use of the map").
//
// One planner is asked first, the other if the first has no route: for a missing or unfinished
// grid, a door that noise on the grid has shut, or a robot on unknown floor.
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

  /// Whether any map has a zone or a branch to plan on.
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

/// A route from a point of the map frame. `filled_m`: points of obstacles that are not on the map.
/// The parts of the route name the basis of the plan. If neither planner has a route, returns the
/// hybrid planner's answer, or without zones that of the other. Throws std::invalid_argument like
/// `check` of the settings.
HybridRoute plan_to_goal(const PlanningMaps& maps, const Eigen::Vector2d& from_m, const Target& to,
                         std::span<const Eigen::Vector2d> filled_m = {},
                         const GoalPlannerConfig& config = {});

/// Converts a route along branches to the form of the grid planner: with the lines from the start
/// to the first branch and from the last one to the goal, and without points that are nearly in
/// line.
HybridRoute along_branches(const PlanResult& result, const Eigen::Vector2d& from_m,
                           const Eigen::Vector2d& to_m);

}  // namespace topogeo::planning
