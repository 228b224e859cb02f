#include "topogeo/planning/route_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "topogeo/support/format.hpp"

#include "branch_access.hpp"
#include "branch_network.hpp"
#include "branch_rules.hpp"

namespace topogeo::planning {
namespace {

using topomap::GlobalMap;
using topomap::MapBranch;

Snap to_snap(const GlobalMap& map, const BranchPlace& place) {
  return {place.at, place.distance_m, map.branches[place.branch].id};
}

PlanResult no_route(PlanStatus status, std::string reason) {
  PlanResult result;
  result.status = status;
  result.reason = std::move(reason);
  return result;
}

void set_too_far(PlanResult& result, PlanStatus status, const char* what, const Snap& snap,
                 const PlanningConfig& config) {
  result.status = status;
  result.reason = fmt::format(
      "{} is {:.2f} m from the nearest passable branch at ({:.2f}, {:.2f}), expected at most "
      "{:.2f} m",
      what, snap.distance_m, snap.nearest.position_m.x(), snap.nearest.position_m.y(),
      config.max_snap_m);
}

// The cells that the rules apply to: those of the grid, or as many as the map needs.
GridFrame rules_frame(const GlobalMap& map, const PlanScene& scene) {
  if (scene.space != nullptr) return scene.space->frame();
  constexpr double kMargin_m = 5.0;  // more than start and goal are off the branches
  std::vector<Eigen::Vector2d> points_m;
  for (const MapBranch& branch : map.branches) {
    for (const topomap::BranchPoint& p : branch.points) points_m.push_back(p.position_m);
  }
  return frame_around(points_m, kMargin_m);
}

// Adds points, so that a part can end where a long straight piece is closed.
GlobalMap with_dense_branches(const GlobalMap& map) {
  constexpr double kStep_m = 0.1;
  GlobalMap dense;
  dense.nodes = map.nodes;
  for (const MapBranch& branch : map.branches) {
    MapBranch& copy = dense.branches.emplace_back(branch);
    copy.points.clear();
    for (std::size_t i = 0; i < branch.points.size(); ++i) {
      const topomap::BranchPoint& to = branch.points[i];
      if (i > 0) {
        const topomap::BranchPoint& from = branch.points[i - 1];
        const int steps =
            static_cast<int>(std::ceil((to.position_m - from.position_m).norm() / kStep_m));
        for (int k = 1; k < steps; ++k) {
          const double share = static_cast<double>(k) / steps;
          copy.points.push_back({from.position_m + share * (to.position_m - from.position_m),
                                 from.clearance_m + share * (to.clearance_m - from.clearance_m)});
        }
      }
      copy.points.push_back(to);
    }
  }
  return dense;
}

// Sets whether the width or the map separates start and goal.
void set_apart(PlanResult& result, bool reachable_when_narrow, const PlanningConfig& config) {
  if (reachable_when_narrow) {
    result.status = PlanStatus::kTooNarrow;
    result.reason = fmt::format(
        "every path from start to goal is narrower than the required clearance of {:.2f} m",
        config.min_clearance_m);
  } else {
    result.status = PlanStatus::kNotConnected;
    result.reason = "start and goal lie on disconnected parts of the map";
  }
}

// One query: the accesses of start and goal, and the route between them.
class RouteSearch {
 public:
  RouteSearch(const GlobalMap& map, const PlanningConfig& config, const BranchRules& rules,
              const PlanScene& scene)
      : map_(map), config_(config), rules_(rules), scene_(scene) {}

  void run(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, PlanResult& result) const {
    const AccessFinder finder(map_, config_, rules_, scene_.space);
    const auto entries = finder.of(from_m, AccessFinder::End::kStart);
    if (entries.empty()) {
      set_shut(result, PlanStatus::kStartShut, "start");
      return;
    }
    auto exits = finder.of(to_m, AccessFinder::End::kGoal);
    if (scene_.prove_goal) {
      std::erase_if(exits, [](const BranchAccess& exit) { return !exit.proved; });
    }
    if (exits.empty()) {
      set_shut(result, PlanStatus::kGoalShut, "goal");
      return;
    }
    BranchNetwork network(map_, config_.min_clearance_m, rules_);
    if (auto path = network.cheapest(entries, exits)) {
      const BranchPlace& start = entries[path->from].place;
      const BranchPlace& goal = exits[path->to].place;
      result.status = PlanStatus::kFound;
      result.start = to_snap(map_, start);
      result.goal = to_snap(map_, goal);
      result.route = std::move(path->route);
      if (result.route.points.empty()) set_place(start, result.route);
      return;
    }
    set_unreachable(entries, exits, result);
  }

 private:
  // Start and goal are the same place.
  void set_place(const BranchPlace& place, Route& route) const {
    const MapBranch& branch = map_.branches[place.branch];
    route.points.push_back(place.at);
    route.min_clearance_m = place.at.clearance_m;
    route.branch_ids.push_back(branch.id);
    route.parts.push_back(
        {branch.is_virtual ? PlannedOn::kVirtualBranch : PlannedOn::kBranch, branch.id, 0});
  }

  void set_shut(PlanResult& result, PlanStatus status, const char* what) const {
    result.status = status;
    result.reason =
        fmt::format("no free straight line leads from the {} to a passable branch within {:.2f} m",
                    what, config_.max_snap_m);
  }

  // Sets whether the width, closed parts or the map separate start and goal.
  void set_unreachable(std::span<const BranchAccess> entries, std::span<const BranchAccess> exits,
                       PlanResult& result) const {
    const BranchRules nothing;
    if (!rules_.empty() &&
        BranchNetwork(map_, config_.min_clearance_m, nothing).cheapest(entries, exits)) {
      result.status = PlanStatus::kClosed;
      result.reason = "every path along branches is closed now or by a zone";
      return;
    }
    const bool when_narrow = BranchNetwork(map_, 0.0, nothing).cheapest(entries, exits).has_value();
    set_apart(result, when_narrow, config_);
  }

  const GlobalMap& map_;
  const PlanningConfig& config_;
  const BranchRules& rules_;
  const PlanScene& scene_;
};

}  // namespace

std::string_view describe(PlanStatus status) {
  switch (status) {
    case PlanStatus::kFound:
      return "found";
    case PlanStatus::kEmptyMap:
      return "empty map";
    case PlanStatus::kTooNarrow:
      return "too narrow";
    case PlanStatus::kStartTooFar:
      return "start too far from the map";
    case PlanStatus::kGoalTooFar:
      return "goal too far from the map";
    case PlanStatus::kNotConnected:
      return "not connected";
    case PlanStatus::kUnknownNode:
      return "unknown node";
    case PlanStatus::kInvalidPoint:
      return "invalid point";
    case PlanStatus::kStartShut:
      return "start shut off from the map";
    case PlanStatus::kGoalShut:
      return "goal shut off from the map";
    case PlanStatus::kClosed:
      return "closed";
  }
  return "unknown status";
}

PlanResult plan(const GlobalMap& map, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                const PlanningConfig& config, const PlanScene& scene) {
  check(config);
  if (!from_m.allFinite() || !to_m.allFinite()) {
    return no_route(PlanStatus::kInvalidPoint, "start or goal is not finite");
  }
  if (!nearest_place(map, from_m, -std::numeric_limits<double>::infinity())) {
    return no_route(PlanStatus::kEmptyMap, "the map has no branches");
  }
  const auto start = nearest_place(map, from_m, config.min_clearance_m);
  const auto goal = nearest_place(map, to_m, config.min_clearance_m);
  if (!start || !goal) {
    return no_route(
        PlanStatus::kTooNarrow,
        fmt::format("no branch has the required clearance of {:.2f} m", config.min_clearance_m));
  }
  PlanResult result;
  result.start = to_snap(map, *start);
  result.goal = to_snap(map, *goal);
  if (start->distance_m > config.max_snap_m) {
    set_too_far(result, PlanStatus::kStartTooFar, "start", *result.start, config);
    return result;
  }
  if (goal->distance_m > config.max_snap_m) {
    set_too_far(result, PlanStatus::kGoalTooFar, "goal", *result.goal, config);
    return result;
  }
  if (scene.zones.empty() && scene.lines.empty() && scene.filled_m.empty()) {
    RouteSearch(map, config, BranchRules(), scene).run(from_m, to_m, result);
    return result;
  }
  const BranchRules rules(rules_frame(map, scene), scene.zones, scene.lines, scene.filled_m,
                          config.min_clearance_m);
  RouteSearch(with_dense_branches(map), config, rules, scene).run(from_m, to_m, result);
  return result;
}

PlanResult plan_between_nodes(const GlobalMap& map, std::uint32_t from_node, std::uint32_t to_node,
                              const PlanningConfig& config) {
  check(config);
  if (map.branches.empty()) return no_route(PlanStatus::kEmptyMap, "the map has no branches");
  for (const std::uint32_t id : {from_node, to_node}) {
    const bool is_node =
        std::ranges::any_of(map.nodes, [id](const auto& node) { return node.id == id; });
    const bool has_branch = std::ranges::any_of(
        map.branches, [id](const MapBranch& b) { return b.node_a == id || b.node_b == id; });
    if (!is_node || !has_branch) {
      return no_route(PlanStatus::kUnknownNode,
                      fmt::format("the map has no branch at a node {}", id));
    }
  }
  PlanResult result;
  const BranchRules nothing;
  if (auto route =
          BranchNetwork(map, config.min_clearance_m, nothing).between_nodes(from_node, to_node)) {
    result.status = PlanStatus::kFound;
    result.route = std::move(*route);
    return result;
  }
  set_apart(result, BranchNetwork(map, 0.0, nothing).between_nodes(from_node, to_node).has_value(),
            config);
  return result;
}

}  // namespace topogeo::planning
