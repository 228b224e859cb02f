#include "route_query.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cell_order.hpp"
#include "crossings.hpp"
#include "straighten.hpp"

namespace topogeo::planning {
namespace {

// If two pieces meet in one cell, because a route touches a border without crossing it, that cell
// is added once.
void append(std::vector<Cell>& cells, std::vector<Cell> piece, bool backwards) {
  if (backwards) std::reverse(piece.begin(), piece.end());
  const auto skip = static_cast<std::ptrdiff_t>(cells.back() == piece.front() ? 1 : 0);
  cells.insert(cells.end(), piece.begin() + skip, piece.end());
}

// Reach of the ellipse around the ends that contains all shorter paths. 0 if none is shorter.
std::int32_t margin_of(std::span<const Cell> cells) {
  const double cost = cost_cells(cells);
  if (cost <= least_cost_cells(cells.front(), cells.back())) return 0;
  const double across = cells.back().column - cells.front().column;
  const double up = cells.back().row - cells.front().row;
  const double half_axis = 0.5 * std::sqrt(cost * cost - across * across - up * up);
  return static_cast<std::int32_t>(half_axis) + 1;
}

// The cells under straight lines between points.
std::vector<Cell> cells_along(const GridFrame& frame, std::span<const Eigen::Vector2d> points_m) {
  std::vector<Cell> cells;
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    visit_line(frame.in_cells(points_m[i - 1]), frame.in_cells(points_m[i]), [&](const Cell& cell) {
      cells.push_back(cell);
      return true;
    });
  }
  return cells;
}

}  // namespace

// Paths on the grid from a cell to the nodes of its zone, plus half a step across the border.
struct RouteQuery::Reach {
  std::vector<std::uint32_t> nodes;
  std::vector<std::optional<CellPath>> paths;
  std::vector<GraphAccess> accesses;

  [[nodiscard]] const std::vector<Cell>& cells_to(std::uint32_t node) const {
    const auto at = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
    return paths[static_cast<std::size_t>(at)]->cells;
  }
};

HybridRoute RouteQuery::run(const Cell& from, const Cell& to) const {
  const ZoneId zone_from = map_.zone_of(from);
  const ZoneId zone_to = map_.zone_of(to);
  if (zone_from != zone_to) return across(from, to, zone_from, zone_to);
  return within(from, to, zone_from);
}

RouteQuery::Reach RouteQuery::reach(const Cell& cell, ZoneId zone) const {
  Reach reach;
  std::vector<Cell> cells;
  for (const std::uint32_t node : network_.nodes_of(zone)) {
    reach.nodes.push_back(node);
    cells.push_back(network_.cell_in(node, zone));
  }
  SearchWindow window(map_.frame(), map_.zones().zones[zone].box, map_.zones().zone_of_cell, zone);
  cells_.close_in(window);
  reach.paths = shortest_paths(window, cell, cells);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!reach.paths[i]) continue;  // in another part of the zone
    const double cost_m = (reach.paths[i]->cost_cells + 0.5) * map_.frame().resolution_m;
    reach.accesses.push_back({reach.nodes[i], cost_m});
  }
  return reach;
}

HybridRoute RouteQuery::within(const Cell& from, const Cell& to, ZoneId zone) const {
  HybridRoute route;
  route.cells = cells_within(from, to, zone);
  if (!route.cells.empty()) {
    constexpr double kLong = 1.05;
    const bool exact = improve_whole(route.cells);
    name_nodes_and_edges(route);
    if (exact || cost_cells(route.cells) <= kLong * least_cost_cells(from, to)) return route;
  }
  HybridRoute outside = across(from, to, zone, zone);
  if (outside.cells.empty()) return route;
  if (!route.cells.empty() && cost_cells(outside.cells) >= cost_cells(route.cells)) return route;
  outside.kind = RouteKind::kSameZone;
  return outside;
}

// Empty if closed parts cut the zone in two.
std::vector<Cell> RouteQuery::cells_within(const Cell& from, const Cell& to, ZoneId zone) const {
  const CellBox& box = map_.zones().zones[zone].box;
  SearchWindow window(map_.space(), box);
  close_parts(window, zone);
  auto path = shortest_path(window, from, to);
  if (path && uses_closed_edge(path->cells)) {
    SearchWindow zone_only(map_.frame(), box, map_.zones().zone_of_cell, zone);
    cells_.close_in(zone_only);
    path = shortest_path(zone_only, from, to);
  }
  return path ? std::move(path->cells) : std::vector<Cell>();
}

HybridRoute RouteQuery::across(const Cell& from, const Cell& to, ZoneId zone_from,
                               ZoneId zone_to) const {
  HybridRoute route;
  const Reach start = reach(from, zone_from);
  const Reach goal = reach(to, zone_to);
  const auto path = network_.cheapest(start.accesses, goal.accesses);
  if (!path) return route;
  const auto& ends = map_.nodes_of(zone_from);
  const bool adjacent = std::any_of(ends.begin(), ends.end(), [&](std::uint32_t node) {
    const auto& zones = map_.nodes()[node].zones;
    return zones[0] == zone_to || zones[1] == zone_to;
  });
  route.kind = adjacent ? RouteKind::kAdjacentZones : RouteKind::kDistantZones;
  follow(*path, start, goal, route);
  improve(route);
  return route;
}

void RouteQuery::follow(const GraphPath& path, const Reach& start, const Reach& goal,
                        HybridRoute& route) const {
  route.cells = start.cells_to(path.nodes.front());
  route.nodes.push_back(network_.border_node(path.nodes.front()));
  for (std::size_t i = 0; i < path.edges.size(); ++i) {
    const OpenNetwork::Link link = network_.link(path.edges[i]);
    append(route.cells, *link.route, link.node_a != path.nodes[i]);
    if (!link.edge) continue;
    route.edges.push_back(*link.edge);
    route.nodes.push_back(network_.border_node(path.nodes[i + 1]));
  }
  append(route.cells, goal.cells_to(path.nodes.back()), true);
}

void RouteQuery::improve(HybridRoute& route) const {
  const std::vector<Cell> before = route.cells;
  if (!improve_whole(route.cells)) improve_pieces(route.cells);
  if (route.cells == before) return;
  name_nodes_and_edges(route);
}

void RouteQuery::name_nodes_and_edges(HybridRoute& route) const {
  NodesAndEdges used = nodes_and_edges(map_, route.cells);
  route.nodes = std::move(used.nodes);
  route.edges = std::move(used.edges);
}

// Returns whether the path is now the shortest.
bool RouteQuery::improve_whole(std::vector<Cell>& cells) const {
  const std::int32_t margin = margin_of(cells);
  if (margin == 0) return true;
  const CellBox box = box_around(cells.front(), cells.back(), margin);
  const double size = (box.high.column - box.low.column + 1.0) * (box.high.row - box.low.row + 1.0);
  if (size > config_.exact_window_cells) return false;
  return plan_again(cells, 0, cells.size() - 1, margin);
}

void RouteQuery::improve_pieces(std::vector<Cell>& cells) const {
  const auto piece = static_cast<std::size_t>(config_.piece_m / map_.frame().resolution_m);
  if (piece < 2) return;
  for (std::size_t begin = 0; begin + 1 < cells.size(); begin += piece / 2) {
    const std::size_t end = std::min(begin + piece, cells.size() - 1);
    const std::span<const Cell> old(cells.data() + begin, end - begin + 1);
    const auto widest = static_cast<std::int32_t>(piece / 2);
    const std::int32_t margin = std::min(margin_of(old), widest);
    if (margin > 0) (void)plan_again(cells, begin, end, margin);
  }
}

CellBox RouteQuery::box_around(const Cell& a, const Cell& b, std::int32_t margin) const {
  const CellBox box{{std::min(a.column, b.column), std::min(a.row, b.row)},
                    {std::max(a.column, b.column), std::max(a.row, b.row)}};
  return grown(box, margin, map_.frame());
}

// Plans the piece from `begin` to `end` again, in a window with a margin around both cells. False
// if a shorter one leads through a closed edge and cannot be used.
bool RouteQuery::plan_again(std::vector<Cell>& cells, std::size_t begin, std::size_t end,
                            std::int32_t margin) const {
  const Cell& a = cells[begin];
  const Cell& b = cells[end];
  SearchWindow window(map_.space(), box_around(a, b, margin));
  close_parts(window, map_.zone_of(a));
  const auto path = shortest_path(window, a, b);
  constexpr double kRounding_cells = 1e-9;
  const std::span<const Cell> old(cells.data() + begin, end - begin + 1);
  if (!path || path->cost_cells >= cost_cells(old) - kRounding_cells) return true;
  std::vector<Cell> shorter(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(begin));
  shorter.insert(shorter.end(), path->cells.begin(), path->cells.end());
  shorter.insert(shorter.end(), cells.begin() + static_cast<std::ptrdiff_t>(end + 1), cells.end());
  if (uses_closed_edge(shorter)) return false;
  cells = std::move(shorter);
  return true;
}

// One side of a closed border is enough; the side in `keep`, where a search begins, stays open.
void RouteQuery::close_parts(SearchWindow& window, ZoneId keep) const {
  for (const std::uint32_t id : closed_.nodes) {
    const BorderNode& node = map_.nodes()[id];
    for (const Cell& cell : node.border[node.zones[1] == keep ? 0 : 1]) window.close(cell);
  }
  cells_.close_in(window);
}

bool RouteQuery::uses_closed_edge(std::span<const Cell> cells) const {
  if (closed_.edges.empty()) return false;
  const auto used = nodes_and_edges(map_, cells).edges;
  return std::any_of(used.begin(), used.end(), [&](std::uint32_t edge) {
    return std::find(closed_.edges.begin(), closed_.edges.end(), edge) != closed_.edges.end();
  });
}

bool RouteQuery::needs_rules(std::span<const Cell> cells) const {
  const DrivingRules& rules = map_.space().rules();
  if (!rules.guides() || cells.empty()) return false;
  return rules.prefers() || std::ranges::any_of(cells, [&](const Cell& cell) {
           return rules.area(map_.frame().index(cell)) != 0;
         });
}

HybridRoute RouteQuery::obedient(const Cell& from, const Cell& to) const {
  HybridRoute route = run(from, to);
  return needs_rules(route.cells) ? run_by_rules(from, to) : route;
}

std::vector<bool> RouteQuery::within_reach(const Cell& from) const {
  std::vector<bool> reached = network_.within_reach(from);
  if (!map_.space().rules().guides()) return reached;
  SearchWindow window(map_.space(), whole(map_.frame()), SearchWindow::Rules::kObeyed);
  cells_.close_in(window);
  close_parts(window, map_.zone_of(from));
  const std::vector<bool> by_rules = reached_cells(window, map_.frame(), from);
  for (std::size_t i = 0; i < reached.size(); ++i) reached[i] = reached[i] && by_rules[i];
  return reached;
}

HybridRoute RouteQuery::run_by_rules(const Cell& from, const Cell& to) const {
  HybridRoute route;
  SearchWindow window(map_.space(), whole(map_.frame()), SearchWindow::Rules::kObeyed);
  cells_.close_in(window);
  close_parts(window, map_.zone_of(from));
  auto path = shortest_path(window, from, to);
  if (!path || uses_closed_edge(path->cells)) return route;
  route.cells = std::move(path->cells);
  name_nodes_and_edges(route);
  if (map_.zone_of(from) != map_.zone_of(to)) {
    route.kind = route.nodes.size() > 1 ? RouteKind::kDistantZones : RouteKind::kAdjacentZones;
  }
  return route;
}

std::vector<Eigen::Vector2d> RouteQuery::straightened(std::span<const Cell> cells,
                                                      const Eigen::Vector2d& from_m,
                                                      const Eigen::Vector2d& to_m) const {
  std::vector<Cell> borders;
  for (const std::uint32_t id : closed_.nodes) {
    const auto& side = map_.nodes()[id].border[0];
    borders.insert(borders.end(), side.begin(), side.end());
  }
  sort_cells(borders);
  const auto open = [&](const Cell& cell) {
    return map_.space().passable(cell) && !cells_.forbids(cell) &&
           (borders.empty() || !has_cell(borders, cell));
  };
  auto points_m = straighten_by_rules(map_.space(), open, cells, from_m, to_m);
  if (!uses_closed_edge(cells_along(map_.frame(), points_m))) return points_m;
  const auto nowhere = [](const Cell&) { return false; };
  return straighten_where(map_.frame(), nowhere, cells, from_m, to_m);
}

}  // namespace topogeo::planning
