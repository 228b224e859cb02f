#include "topogeo/planning/hybrid_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "topogeo/planning/motion_primitives.hpp"

#include "closed_cells.hpp"
#include "drawn_obstructions.hpp"
#include "goal_target.hpp"
#include "route_ends.hpp"
#include "route_query.hpp"

namespace topogeo::planning {
namespace {

void check_closures(const HybridMap& map, const Closures& closed) {
  for (const std::uint32_t node : closed.nodes) {
    if (node >= map.nodes().size()) {
      throw std::invalid_argument("planner: closed node " + std::to_string(node) +
                                  " does not exist");
    }
  }
  for (const std::uint32_t edge : closed.edges) {
    if (edge >= map.edges().size()) {
      throw std::invalid_argument("planner: closed edge " + std::to_string(edge) +
                                  " does not exist");
    }
  }
}

std::vector<ZoneId> zones_along(const HybridMap& map, const std::vector<Cell>& cells) {
  std::vector<ZoneId> zones;
  for (const Cell& cell : cells) {
    const ZoneId zone = map.zone_of(cell);
    if (zones.empty() || zones.back() != zone) zones.push_back(zone);
  }
  return zones;
}

/// Why no path leads from one open cell to another, if that is known.
std::optional<std::string> why_unreachable(const HybridMap& map, const Closures& closed,
                                           const ClosedCells& cells, const Cell& from,
                                           const Cell& to) {
  const bool parts_closed = !closed.nodes.empty() || !closed.edges.empty();
  if (!parts_closed) {
    const auto items = drawn_items_between(map.space(), cells, from, to);
    if (!items.empty()) return in_the_way(items);
  }
  if (!parts_closed && cells.empty()) return std::nullopt;
  return "no path leads there past what is closed now";
}

}  // namespace

std::string_view describe(RouteStatus status) {
  constexpr std::array<std::string_view, 9> kWords = {
      "found",          "invalid point", "unknown place", "unknown node", "start outside",
      "start occupied", "goal outside",  "goal occupied", "unreachable"};
  const auto index = static_cast<std::size_t>(status);
  return index < kWords.size() ? kWords.at(index) : "unknown status";
}

double length_on(const HybridRoute& route, PlannedOn on) {
  double sum_m = 0.0;
  for (std::size_t k = 0; k < route.parts.size(); ++k) {
    if (route.parts[k].on != on) continue;
    const std::size_t end =
        k + 1 < route.parts.size() ? route.parts[k + 1].first_point : route.points_m.size() - 1;
    for (std::size_t i = route.parts[k].first_point; i < end; ++i) {
      sum_m += (route.points_m[i + 1] - route.points_m[i]).norm();
    }
  }
  return sum_m;
}

HybridPlanner::HybridPlanner(const HybridMap& map, const HybridPlannerConfig& config)
    : map_(map), config_(config) {
  check(config);
}

HybridRoute HybridPlanner::plan(const Eigen::Vector2d& from_m, const Target& to,
                                const Closures& closed) const {
  check_closures(map_, closed);
  const GoalTarget goal = resolve(&map_, to);
  if (!goal.known) return goal.failure;
  if (!from_m.allFinite() || !goal.point_m.allFinite()) {
    return no_route(RouteStatus::kInvalidPoint, "start or goal is not finite");
  }
  HybridRoute route;
  const ClosedCells cells(map_.space(), closed.cells);
  const EndFinder ends(map_.space(), cells);
  const auto start_cell = ends.start(from_m, config_.start_snap_m, route);
  if (!start_cell) return route;
  const auto goal_cell = ends.goal(goal.point_m, config_.goal_snap_m, route);
  const ClosedParts parts{closed.nodes, closed.edges};
  const RouteQuery query(map_, config_, parts, cells);
  if (goal_cell) {
    // A robot on forbidden floor, or shut in, came from one of the zones around it.
    std::vector<ZoneId> tried;
    for (auto start = start_cell; start;
         start = ends.start_apart(map_, from_m, config_.start_snap_m, tried)) {
      route = query.obedient(*start, *goal_cell);
      if (!route.cells.empty()) break;
      tried.push_back(map_.zone_of(*start));
    }
    if (!route.cells.empty()) {
      route.status = RouteStatus::kFound;
      route.zones = zones_along(map_, route.cells);
      route.points_m = query.straightened(route.cells, from_m, goal.point_m);
      measure(cells, map_.frame(), route);
      route.parts = {{PlannedOn::kGrid, 0, 0}};
      return route;
    }
    route = no_route(
        RouteStatus::kUnreachable,
        why_unreachable(map_, closed, cells, *start_cell, *goal_cell)
            .value_or("no path leads from " + shown(from_m) + " to " + shown(goal.point_m)));
  }
  const std::vector<bool> reachable = query.within_reach(*start_cell);
  const auto nearest_m = nearest_cell_m(map_.frame(), goal.point_m, reachable);
  if (nearest_m) {
    const Cell nearest = map_.frame().cell_of(*nearest_m).value();
    if (!query.obedient(*start_cell, nearest).cells.empty()) route.nearest_reachable_m = nearest_m;
  }
  return route;
}

HybridRoute plan_on_grid(const FreeSpace& space, const Eigen::Vector2d& from_m,
                         const Eigen::Vector2d& to_m, const HybridPlannerConfig& config) {
  check(config);
  if (!from_m.allFinite() || !to_m.allFinite()) {
    return no_route(RouteStatus::kInvalidPoint, "start or goal is not finite");
  }
  HybridRoute route;
  const ClosedCells nothing(space, {});
  const EndFinder ends(space, nothing);
  const auto start = ends.start(from_m, config.start_snap_m, route);
  if (!start) return route;
  const auto goal = ends.goal(to_m, config.goal_snap_m, route);
  if (!goal) return route;
  const SearchWindow window(space, whole(space.frame()), SearchWindow::Rules::kObeyed);
  auto path = shortest_path(window, *start, *goal);
  if (!path) {
    return no_route(RouteStatus::kUnreachable,
                    "no path leads from " + shown(from_m) + " to " + shown(to_m));
  }
  route.status = RouteStatus::kFound;
  route.cells = std::move(path->cells);
  route.points_m = straighten(space, route.cells, from_m, to_m);
  measure(nothing, space.frame(), route);
  route.parts = {{PlannedOn::kGrid, 0, 0}};
  return route;
}

}  // namespace topogeo::planning
