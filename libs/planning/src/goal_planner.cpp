#include "topogeo/planning/goal_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "topogeo/planning/motion_primitives.hpp"

#include "goal_target.hpp"
#include "route_ends.hpp"

namespace topogeo::planning {
namespace {

RouteStatus status_of(PlanStatus status) {
  switch (status) {
    case PlanStatus::kFound:
      return RouteStatus::kFound;
    case PlanStatus::kInvalidPoint:
      return RouteStatus::kInvalidPoint;
    case PlanStatus::kStartTooFar:
      return RouteStatus::kStartOutside;
    case PlanStatus::kStartShut:
      return RouteStatus::kStartOccupied;
    case PlanStatus::kGoalTooFar:
      return RouteStatus::kGoalOutside;
    case PlanStatus::kGoalShut:
      return RouteStatus::kGoalOccupied;
    default:
      return RouteStatus::kUnreachable;
  }
}

// Selects the points of a part so that all others lie near the lines between them (Douglas and
// Peucker 1973): branches have a point every few centimetres, and each would be a turn of the
// robot.
void keep_corners(std::span<const RoutePoint> points, std::size_t first, std::size_t last,
                  std::vector<bool>& kept) {
  constexpr double kInLine_m = 0.03;  // below the accuracy of branches, half a cell
  kept[first] = kept[last] = true;
  if (last - first < 2) return;
  const Eigen::Vector2d from_m = points[first].position_m;
  const Eigen::Vector2d line_m = points[last].position_m - from_m;
  const double length2 = line_m.squaredNorm();
  std::size_t farthest = first;
  double most_m = 0.0;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Eigen::Vector2d at_m = points[i].position_m - from_m;
    const double share = length2 > 0.0 ? std::clamp(at_m.dot(line_m) / length2, 0.0, 1.0) : 0.0;
    const double off_m = (at_m - share * line_m).norm();
    if (off_m > most_m) {
      most_m = off_m;
      farthest = i;
    }
  }
  if (most_m <= kInLine_m) return;
  keep_corners(points, first, farthest, kept);
  keep_corners(points, farthest, last, kept);
}

class BranchRoute {
 public:
  BranchRoute(const Route& along, HybridRoute& route) : along_(along), route_(route) {}

  void run(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    constexpr double kSame_m = 1e-6;
    if ((along_.points.front().position_m - from_m).norm() > kSame_m) {
      route_.parts.push_back({PlannedOn::kOffBranch, 0, 0});
      add(from_m, least_clearance_m(along_.points.front(), from_m));
    }
    const std::vector<bool> kept = corners();
    std::size_t part = 0;
    for (std::size_t i = 0; i < along_.points.size(); ++i) {
      while (part < along_.parts.size() && along_.parts[part].first_point == i) {
        route_.parts.push_back(along_.parts[part]);
        route_.parts.back().first_point = route_.points_m.size();
        ++part;
      }
      if (kept[i]) add(along_.points[i].position_m, along_.points[i].clearance_m);
    }
    if ((along_.points.back().position_m - to_m).norm() > kSame_m) {
      route_.parts.push_back({PlannedOn::kOffBranch, 0, route_.points_m.size() - 1});
      add(to_m, least_clearance_m(along_.points.back(), to_m));
    }
  }

 private:
  static double least_clearance_m(const RoutePoint& beside, const Eigen::Vector2d& point_m) {
    return std::max(0.0, beside.clearance_m - (beside.position_m - point_m).norm());
  }

  void add(const Eigen::Vector2d& point_m, double clearance_m) {
    route_.points_m.push_back(point_m);
    route_.clearances_m.push_back(clearance_m);
  }

  // Keeps the ends of parts, so that each part has its own points.
  [[nodiscard]] std::vector<bool> corners() const {
    std::vector<bool> kept(along_.points.size(), false);
    for (std::size_t k = 0; k < along_.parts.size(); ++k) {
      const std::size_t first = along_.parts[k].first_point;
      const std::size_t last =
          k + 1 < along_.parts.size() ? along_.parts[k + 1].first_point : along_.points.size() - 1;
      keep_corners(along_.points, first, last, kept);
    }
    return kept;
  }

  const Route& along_;
  HybridRoute& route_;
};

HybridRoute plan_on_graph(const PlanningMaps& maps, const Eigen::Vector2d& from_m,
                          const Eigen::Vector2d& to_m, std::span<const Eigen::Vector2d> filled_m,
                          const PlanningConfig& config) {
  PlanScene scene;
  scene.prove_goal = true;
  scene.filled_m = filled_m;
  if (maps.hybrid != nullptr) {
    scene.space = &maps.hybrid->space();
    scene.zones = maps.hybrid->space().rules().zones();
    scene.lines = maps.hybrid->space().rules().lines();
  }
  HybridRoute route = along_branches(plan(*maps.graph, from_m, to_m, config, scene), from_m, to_m);
  // The branch nearest to the goal may be out of reach itself.
  if (const auto nearest_m = route.nearest_reachable_m;
      nearest_m && !plan(*maps.graph, from_m, *nearest_m, config, scene).found()) {
    route.nearest_reachable_m.reset();
  }
  return route;
}

Closures closures_of(const HybridMap& map, std::span<const Eigen::Vector2d> filled_m) {
  Closures closed;
  for (const Eigen::Vector2d& point_m : filled_m) {
    if (const auto cell = map.frame().cell_of(point_m)) closed.cells.push_back(*cell);
  }
  return closed;
}

}  // namespace

HybridRoute along_branches(const PlanResult& result, const Eigen::Vector2d& from_m,
                           const Eigen::Vector2d& to_m) {
  HybridRoute route;
  route.status = status_of(result.status);
  route.reason = result.reason;
  if (!result.found()) {
    if (result.status == PlanStatus::kGoalTooFar || result.status == PlanStatus::kGoalShut) {
      route.nearest_reachable_m = result.goal->nearest.position_m;
    }
    return route;
  }
  BranchRoute(result.route, route).run(from_m, to_m);
  route.length_m = length_m(route.points_m);
  route.cost_m = route.length_m;
  route.min_clearance_m = result.route.min_clearance_m;
  return route;
}

HybridRoute plan_to_goal(const PlanningMaps& maps, const Eigen::Vector2d& from_m, const Target& to,
                         std::span<const Eigen::Vector2d> filled_m,
                         const GoalPlannerConfig& config) {
  const GoalTarget goal = resolve(maps.hybrid, to);
  if (!goal.known) return goal.failure;
  if (!from_m.allFinite() || !goal.point_m.allFinite()) {
    return no_route(RouteStatus::kInvalidPoint, "start or goal is not finite");
  }
  const bool has_zones = maps.hybrid != nullptr && !maps.hybrid->zones().zones.empty();
  const bool has_branches = maps.graph != nullptr && !maps.graph->branches.empty();
  const auto on_grid = [&] {
    return HybridPlanner(*maps.hybrid, config.hybrid)
        .plan(from_m, to, closures_of(*maps.hybrid, filled_m));
  };
  const auto on_graph = [&] {
    return plan_on_graph(maps, from_m, goal.point_m, filled_m, config.graph);
  };
  if (!has_branches && !has_zones) {
    return no_route(RouteStatus::kUnreachable, "the map has neither zones nor branches");
  }
  if (!has_branches) return on_grid();
  if (!has_zones) return on_graph();
  if (config.planner.on == PlanFirstOn::kGraph) {
    HybridRoute route = on_graph();
    return route.found() ? route : on_grid();
  }
  HybridRoute route = on_grid();
  if (route.found()) return route;
  HybridRoute other = on_graph();
  return other.found() ? other : route;
}

}  // namespace topogeo::planning
