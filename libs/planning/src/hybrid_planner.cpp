#include "topogeo/planning/hybrid_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "route_ends.hpp"

namespace topogeo::planning {
namespace {

void check_range(const char* field, double value, double high) {
  if (value >= 0.0 && value <= high) return;
  std::ostringstream text;
  text << "planner: " << field << " is " << value << " m, allowed are 0 to " << high << " m";
  throw std::invalid_argument(text.str());
}

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

// One query: start and goal are good.
class Query {
 public:
  Query(const HybridMap& map, const HybridPlannerConfig& config, const Closures& closed)
      : map_(map), config_(config), closed_(closed) {}

  [[nodiscard]] HybridRoute run(const Cell& from, const Cell& to) const {
    const ZoneId zone_from = map_.zone_of(from);
    const ZoneId zone_to = map_.zone_of(to);
    if (zone_from != zone_to) return across(from, to, zone_from, zone_to);
    return within(from, to, zone_from);
  }

  /// Whether each zone can be reached from a zone.
  [[nodiscard]] std::vector<bool> zones_within_reach(ZoneId from) const {
    std::vector<GraphAccess> entries;
    for (const std::uint32_t node : map_.nodes_of(from)) entries.push_back({node, 0.0});
    std::vector<bool> zones(map_.zones().zones.size(), false);
    zones[from] = true;
    const std::vector<bool> nodes = map_.graph().reached(entries, closed_);
    for (const BorderNode& node : map_.nodes()) {
      if (!nodes[node.id]) continue;
      for (const ZoneId zone : node.zones) zones[zone] = true;
    }
    return zones;
  }

 private:
  // Ways on the grid from a cell to the nodes of its zone, with half a step across the border.
  struct Reach {
    std::vector<std::uint32_t> nodes;
    std::vector<std::optional<CellPath>> paths;
    std::vector<GraphAccess> accesses;

    [[nodiscard]] const std::vector<Cell>& cells_to(std::uint32_t node) const {
      const auto at = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
      return paths[static_cast<std::size_t>(at)]->cells;
    }
  };

  [[nodiscard]] Reach reach(const Cell& cell, ZoneId zone) const {
    Reach reach;
    std::vector<Cell> cells;
    for (const std::uint32_t node : map_.nodes_of(zone)) {
      reach.nodes.push_back(node);
      cells.push_back(map_.nodes()[node].cell_in(zone));
    }
    const SearchWindow window(map_.frame(), map_.zones().zones[zone].box, map_.zones().zone_of_cell,
                              zone);
    reach.paths = shortest_paths(window, cell, cells);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double cost_m = (reach.paths[i].value().cost_cells + 0.5) * map_.frame().resolution_m;
      reach.accesses.push_back({reach.nodes[i], cost_m});
    }
    return reach;
  }

  HybridRoute within(const Cell& from, const Cell& to, ZoneId zone) const {
    HybridRoute route;
    SearchWindow window(map_.space(), map_.zones().zones[zone].box);
    close_borders(window, zone);
    // Zones hang together, so there is a way.
    route.cells = shortest_path(window, from, to).value().cells;
    constexpr double kLongWay = 1.05;
    const bool exact = improve_whole(route.cells);
    if (exact || cost_cells(route.cells) <= kLongWay * least_cost_cells(from, to)) return route;
    HybridRoute outside = across(from, to, zone, zone);
    if (outside.cells.empty() || cost_cells(outside.cells) >= cost_cells(route.cells)) return route;
    outside.kind = RouteKind::kSameZone;
    return outside;
  }

  HybridRoute across(const Cell& from, const Cell& to, ZoneId zone_from, ZoneId zone_to) const {
    const Reach start = reach(from, zone_from);
    const Reach goal = reach(to, zone_to);
    const auto path = map_.graph().cheapest(start.accesses, goal.accesses, closed_);
    if (!path) return no_route(RouteStatus::kUnreachable, "");
    HybridRoute route;
    route.nodes = path->nodes;
    route.edges = path->edges;
    const auto& ends = map_.nodes_of(zone_from);
    const bool adjacent = std::any_of(ends.begin(), ends.end(), [&](std::uint32_t node) {
      const auto& zones = map_.nodes()[node].zones;
      return zones[0] == zone_to || zones[1] == zone_to;
    });
    route.kind = adjacent ? RouteKind::kAdjacentZones : RouteKind::kDistantZones;
    route.cells = start.cells_to(path->nodes.front());
    for (std::size_t i = 0; i < path->edges.size(); ++i) {
      const HybridEdge& edge = map_.edges()[path->edges[i]];
      append(route.cells, edge.route, edge.node_a != path->nodes[i]);
    }
    append(route.cells, goal.cells_to(path->nodes.back()), true);
    improve(route.cells);
    return route;
  }

  // Where two pieces meet in one cell, in a route that touches a border without crossing it, that
  // cell comes once.
  static void append(std::vector<Cell>& cells, std::vector<Cell> piece, bool backwards) {
    if (backwards) std::reverse(piece.begin(), piece.end());
    const auto skip = static_cast<std::ptrdiff_t>(cells.back() == piece.front() ? 1 : 0);
    cells.insert(cells.end(), piece.begin() + skip, piece.end());
  }

  // Returns whether it is the shortest way now.
  bool improve_whole(std::vector<Cell>& cells) const {
    const std::int32_t margin = margin_of(cells);
    if (margin == 0) return true;
    const CellBox box = box_around(cells.front(), cells.back(), margin);
    const double size =
        (box.high.column - box.low.column + 1.0) * (box.high.row - box.low.row + 1.0);
    if (size > config_.exact_window_cells) return false;
    plan_again(cells, 0, cells.size() - 1, margin);
    return true;
  }

  void improve(std::vector<Cell>& cells) const {
    if (improve_whole(cells)) return;
    const auto piece = static_cast<std::size_t>(config_.piece_m / map_.frame().resolution_m);
    if (piece < 2) return;
    for (std::size_t begin = 0; begin + 1 < cells.size(); begin += piece / 2) {
      const std::size_t end = std::min(begin + piece, cells.size() - 1);
      const std::span<const Cell> old(cells.data() + begin, end - begin + 1);
      const auto widest = static_cast<std::int32_t>(piece / 2);
      const std::int32_t margin = std::min(margin_of(old), widest);
      if (margin > 0) plan_again(cells, begin, end, margin);
    }
  }

  // Ways shorter than this one stay in the ellipse around its ends that is as long as it: how far
  // that can reach. 0 when none is shorter.
  static std::int32_t margin_of(std::span<const Cell> cells) {
    const double cost = cost_cells(cells);
    if (cost <= least_cost_cells(cells.front(), cells.back())) return 0;
    const double across = cells.back().column - cells.front().column;
    const double up = cells.back().row - cells.front().row;
    const double half_axis = 0.5 * std::sqrt(cost * cost - across * across - up * up);
    return static_cast<std::int32_t>(half_axis) + 1;
  }

  [[nodiscard]] CellBox box_around(const Cell& a, const Cell& b, std::int32_t margin) const {
    const CellBox box{{std::min(a.column, b.column), std::min(a.row, b.row)},
                      {std::max(a.column, b.column), std::max(a.row, b.row)}};
    return grown(box, margin, map_.frame());
  }

  // Plans the piece from `begin` to `end` again, in a window with a margin around both cells.
  void plan_again(std::vector<Cell>& cells, std::size_t begin, std::size_t end,
                  std::int32_t margin) const {
    const Cell& a = cells[begin];
    const Cell& b = cells[end];
    SearchWindow window(map_.space(), box_around(a, b, margin));
    close_borders(window, map_.zone_of(a));
    const auto path = shortest_path(window, a, b);
    constexpr double kRounding_cells = 1e-9;
    const std::span<const Cell> old(cells.data() + begin, end - begin + 1);
    if (!path || path->cost_cells >= cost_cells(old) - kRounding_cells) return;
    const auto first = cells.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto place = cells.erase(first, first + static_cast<std::ptrdiff_t>(end - begin + 1));
    cells.insert(place, path->cells.begin(), path->cells.end());
  }

  // Of a closed border one side is enough; the side in `keep`, where a search begins, stays open.
  void close_borders(SearchWindow& window, ZoneId keep) const {
    for (const std::uint32_t id : closed_.nodes) {
      const BorderNode& node = map_.nodes()[id];
      for (const Cell& cell : node.border[node.zones[1] == keep ? 0 : 1]) window.close(cell);
    }
  }

  const HybridMap& map_;
  const HybridPlannerConfig& config_;
  const Closures& closed_;
};

std::vector<ZoneId> zones_along(const HybridMap& map, const std::vector<Cell>& cells) {
  std::vector<ZoneId> zones;
  for (const Cell& cell : cells) {
    const ZoneId zone = map.zone_of(cell);
    if (zones.empty() || zones.back() != zone) zones.push_back(zone);
  }
  return zones;
}

struct Goal {
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
  HybridRoute failure;
  bool known = true;
};

Goal resolve(const HybridMap& map, const Target& to) {
  Goal goal;
  if (const auto* point = std::get_if<Eigen::Vector2d>(&to)) {
    goal.point_m = *point;
  } else if (const auto* node = std::get_if<NodeNumber>(&to)) {
    goal.known = node->id < map.nodes().size();
    if (goal.known) {
      // Its position is on the border; the cell on one side of it surely is passable.
      goal.point_m = map.frame().center_m(map.nodes()[node->id].cells[0]);
    } else {
      goal.failure = no_route(RouteStatus::kUnknownNode,
                              "no node has the number " + std::to_string(node->id) +
                                  ", there are " + std::to_string(map.nodes().size()));
    }
  } else {
    const std::string& name = std::get<std::string>(to);
    const Place* place = map.place(name);
    goal.known = place != nullptr;
    if (goal.known) {
      goal.point_m = place->position_m;
    } else {
      goal.failure = no_route(RouteStatus::kUnknownPlace, "no place has the name '" + name + "'");
    }
  }
  return goal;
}

}  // namespace

void check(const HybridPlannerConfig& config) {
  check_range("start_snap_m", config.start_snap_m, 5.0);
  check_range("goal_snap_m", config.goal_snap_m, 5.0);
  check_range("piece_m", config.piece_m, 50.0);
  constexpr double kMostCells = 1e8;
  if (!(config.exact_window_cells >= 0.0 && config.exact_window_cells <= kMostCells)) {
    throw std::invalid_argument("planner: exact_window_cells is " +
                                std::to_string(config.exact_window_cells) +
                                ", allowed are 0 to 1e8");
  }
}

std::string_view describe(RouteStatus status) {
  constexpr std::array<std::string_view, 9> kWords = {
      "found",          "invalid point", "unknown place", "unknown node", "start outside",
      "start occupied", "goal outside",  "goal occupied", "unreachable"};
  const auto index = static_cast<std::size_t>(status);
  return index < kWords.size() ? kWords.at(index) : "unknown status";
}

HybridPlanner::HybridPlanner(const HybridMap& map, const HybridPlannerConfig& config)
    : map_(map), config_(config) {
  check(config);
}

HybridRoute HybridPlanner::plan(const Eigen::Vector2d& from_m, const Target& to,
                                const Closures& closed) const {
  check_closures(map_, closed);
  const Goal goal = resolve(map_, to);
  if (!goal.known) return goal.failure;
  if (!from_m.allFinite() || !goal.point_m.allFinite()) {
    return no_route(RouteStatus::kInvalidPoint, "start or goal is not finite");
  }
  HybridRoute route;
  const FreeSpace& space = map_.space();
  const auto start_cell = find_end(space, from_m, config_.start_snap_m, true, route);
  if (!start_cell) return route;
  const auto goal_cell = find_end(space, goal.point_m, config_.goal_snap_m, false, route);
  Query query(map_, config_, closed);
  if (goal_cell) {
    route = query.run(*start_cell, *goal_cell);
    if (!route.cells.empty()) {
      route.zones = zones_along(map_, route.cells);
      fill_in(space, from_m, goal.point_m, route);
      return route;
    }
    route.reason = "no way leads from " + shown(from_m) + " to " + shown(goal.point_m);
    if (!closed.nodes.empty() || !closed.edges.empty()) route.reason += " with what is closed now";
  }
  const std::vector<bool> zones = query.zones_within_reach(map_.zone_of(*start_cell));
  const auto reachable = [&](std::size_t i) {
    const ZoneId zone = map_.zones().zone_of_cell[i];
    return zone != kNoZone && zones[zone];
  };
  route.nearest_reachable_m = nearest_cell_m(map_.frame(), goal.point_m, reachable);
  return route;
}

HybridRoute plan_on_grid(const FreeSpace& space, const Eigen::Vector2d& from_m,
                         const Eigen::Vector2d& to_m, const HybridPlannerConfig& config) {
  check(config);
  if (!from_m.allFinite() || !to_m.allFinite()) {
    return no_route(RouteStatus::kInvalidPoint, "start or goal is not finite");
  }
  HybridRoute route;
  const auto start = find_end(space, from_m, config.start_snap_m, true, route);
  if (!start) return route;
  const auto goal = find_end(space, to_m, config.goal_snap_m, false, route);
  if (!goal) return route;
  const SearchWindow window(space, whole(space.frame()));
  auto path = shortest_path(window, *start, *goal);
  if (!path) {
    return no_route(RouteStatus::kUnreachable,
                    "no way leads from " + shown(from_m) + " to " + shown(to_m));
  }
  route.cells = std::move(path->cells);
  fill_in(space, from_m, to_m, route);
  return route;
}

}  // namespace topogeo::planning
