#include "topogeo/planning/route_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>

#include "topogeo/support/format.hpp"

#include "snapping.hpp"

namespace topogeo::planning {
namespace {

using topomap::GlobalMap;
using topomap::MapBranch;

// A branch, or the part of one between its ends and the places where it is split.
struct Piece {
  std::size_t branch = 0;  // index in GlobalMap::branches
  std::vector<RoutePoint> points;
  double length_m = 0.0;
};

struct RouteEdge {
  double length_m = 0.0;
  std::size_t piece = 0;
};

using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS,
                                    boost::no_property, RouteEdge>;
using Vertex = boost::graph_traits<Graph>::vertex_descriptor;

double narrowest_m(const std::vector<RoutePoint>& points) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const RoutePoint& p : points) narrowest = std::min(narrowest, p.clearance_m);
  return narrowest;
}

double length_of(const std::vector<RoutePoint>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += (points[i].position_m - points[i - 1].position_m).norm();
  }
  return length;
}

// The map as a graph with two extra vertices for start and goal, closed where it is too narrow.
class RoadNetwork {
 public:
  RoadNetwork(const GlobalMap& map, double min_clearance_m)
      : map_(map), min_clearance_m_(min_clearance_m), graph_(map.nodes.size()) {
    for (std::size_t i = 0; i < map.nodes.size(); ++i) vertex_of_node_[map.nodes[i].id] = i;
  }

  [[nodiscard]] std::optional<Vertex> vertex(std::uint32_t node_id) const {
    const auto found = vertex_of_node_.find(node_id);
    if (found == vertex_of_node_.end()) return std::nullopt;
    return found->second;
  }

  // A vertex for each place, in the same order; the other branches stay whole.
  std::vector<Vertex> connect(const std::vector<BranchPlace>& places) {
    std::vector<Vertex> vertices;
    for (std::size_t i = 0; i < places.size(); ++i) vertices.push_back(add_vertex(graph_));
    for (std::size_t b = 0; b < map_.branches.size(); ++b) {
      std::vector<std::size_t> on_branch;
      for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].branch == b) on_branch.push_back(i);
      }
      std::stable_sort(on_branch.begin(), on_branch.end(), [&](std::size_t a, std::size_t c) {
        return std::pair(places[a].segment, places[a].along) <
               std::pair(places[c].segment, places[c].along);
      });
      add_branch(b, places, on_branch, vertices);
    }
    return vertices;
  }

  [[nodiscard]] std::optional<Route> shortest(Vertex from, Vertex to) const {
    std::vector<Vertex> before(num_vertices(graph_));
    std::vector<double> distance_m(num_vertices(graph_));
    boost::dijkstra_shortest_paths(graph_, from,
                                   boost::weight_map(get(&RouteEdge::length_m, graph_))
                                       .predecessor_map(boost::make_iterator_property_map(
                                           before.begin(), get(boost::vertex_index, graph_)))
                                       .distance_map(boost::make_iterator_property_map(
                                           distance_m.begin(), get(boost::vertex_index, graph_))));
    if (from != to && before[to] == to) return std::nullopt;
    std::vector<Vertex> path{to};
    while (path.back() != from) path.push_back(before[path.back()]);
    std::reverse(path.begin(), path.end());
    return route_along(path);
  }

 private:
  void add_branch(std::size_t b, const std::vector<BranchPlace>& places,
                  const std::vector<std::size_t>& on_branch, const std::vector<Vertex>& vertices) {
    const MapBranch& branch = map_.branches[b];
    const std::optional<Vertex> end = vertex(branch.node_b);
    std::optional<Vertex> last = vertex(branch.node_a);
    if (!last || !end || branch.points.empty()) return;
    Piece piece{b, {{branch.points[0].position_m, branch.points[0].clearance_m}}, 0.0};
    std::size_t next = 1;
    for (const std::size_t i : on_branch) {
      for (; next <= places[i].segment; ++next) append(piece, branch.points[next]);
      piece.points.push_back(places[i].at);
      add_piece(*last, vertices[i], piece);
      last = vertices[i];
      piece.points.assign(1, places[i].at);
    }
    for (; next < branch.points.size(); ++next) append(piece, branch.points[next]);
    add_piece(*last, *end, piece);
  }

  static void append(Piece& piece, const topomap::BranchPoint& p) {
    piece.points.push_back({p.position_m, p.clearance_m});
  }

  void add_piece(Vertex from, Vertex to, const Piece& piece) {
    const bool driven = map_.branches[piece.branch].is_virtual;
    if (!driven && narrowest_m(piece.points) < min_clearance_m_) return;
    pieces_.push_back(piece);
    pieces_.back().length_m = length_of(piece.points);
    piece_starts_.push_back(from);
    add_edge(from, to, RouteEdge{pieces_.back().length_m, pieces_.size() - 1}, graph_);
  }

  [[nodiscard]] Route route_along(const std::vector<Vertex>& path) const {
    Route route;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (path[i] < map_.nodes.size()) {
        const topomap::MapNode& node = map_.nodes[path[i]];
        route.node_ids.push_back(node.id);
        if (route.points.empty()) route.points.push_back({node.position_m, node.clearance_m});
      }
      if (i + 1 < path.size()) follow(shortest_edge(path[i], path[i + 1]), path[i], route);
    }
    route.min_clearance_m = narrowest_m(route.points);
    return route;
  }

  // Two nodes can have several branches between them.
  [[nodiscard]] std::size_t shortest_edge(Vertex from, Vertex to) const {
    std::optional<RouteEdge> best;
    const auto [begin, end] = out_edges(from, graph_);
    for (auto it = begin; it != end; ++it) {
      if (target(*it, graph_) != to) continue;
      if (!best || graph_[*it].length_m < best->length_m) best = graph_[*it];
    }
    return best->piece;
  }

  void follow(std::size_t piece_index, Vertex from, Route& route) const {
    const Piece& piece = pieces_[piece_index];
    std::vector<RoutePoint> points = piece.points;
    if (piece_starts_[piece_index] != from) std::reverse(points.begin(), points.end());
    // The first point is where the last piece ended.
    const auto skip = static_cast<std::ptrdiff_t>(route.points.empty() ? 0 : 1);
    route.points.insert(route.points.end(), points.begin() + skip, points.end());
    route.length_m += piece.length_m;
    const std::uint32_t id = map_.branches[piece.branch].id;
    if (route.branch_ids.empty() || route.branch_ids.back() != id) route.branch_ids.push_back(id);
  }

  const GlobalMap& map_;
  double min_clearance_m_;
  Graph graph_;
  std::map<std::uint32_t, Vertex> vertex_of_node_;
  std::vector<Piece> pieces_;
  std::vector<Vertex> piece_starts_;
};

std::optional<Route> shortest_between(const GlobalMap& map, const BranchPlace& start,
                                      const BranchPlace& goal, double min_clearance_m) {
  RoadNetwork network(map, min_clearance_m);
  const std::vector<Vertex> vertices = network.connect({start, goal});
  std::optional<Route> route = network.shortest(vertices[0], vertices[1]);
  if (route && route->points.empty()) {
    route->points.push_back(start.at);
    route->min_clearance_m = start.at.clearance_m;
  }
  return route;
}

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
      "{} is {:.2f} m from the nearest passable branch at ({:.2f}, {:.2f}), allowed are {:.2f} m",
      what, snap.distance_m, snap.nearest.position_m.x(), snap.nearest.position_m.y(),
      config.max_snap_m);
}

// Whether it is the width or the map that keeps the two apart.
void set_unreachable(PlanResult& result, bool reachable_when_narrow, const PlanningConfig& config) {
  if (reachable_when_narrow) {
    result.status = PlanStatus::kTooNarrow;
    result.reason = fmt::format(
        "every path from start to goal is narrower than the clearance of {:.2f} m that is needed",
        config.min_clearance_m);
  } else {
    result.status = PlanStatus::kNotConnected;
    result.reason = "start and goal lie on parts of the map that are not connected";
  }
}

void check_field(const char* field, double value) {
  if (std::isfinite(value) && value >= 0.0) return;
  throw std::invalid_argument(
      fmt::format("planning: {} is {:g}, allowed is a finite value of at least 0", field, value));
}

}  // namespace

void check(const PlanningConfig& config) {
  check_field("max_snap_m", config.max_snap_m);
  check_field("min_clearance_m", config.min_clearance_m);
}

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
  }
  return "unknown status";
}

PlanResult plan(const GlobalMap& map, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                const PlanningConfig& config) {
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
    return no_route(PlanStatus::kTooNarrow,
                    fmt::format("no branch has the clearance of {:.2f} m that is needed",
                                config.min_clearance_m));
  }
  PlanResult result;
  result.start = to_snap(map, *start);
  result.goal = to_snap(map, *goal);
  if (start->distance_m > config.max_snap_m) {
    set_too_far(result, PlanStatus::kStartTooFar, "start", *result.start, config);
  } else if (goal->distance_m > config.max_snap_m) {
    set_too_far(result, PlanStatus::kGoalTooFar, "goal", *result.goal, config);
  } else if (auto route = shortest_between(map, *start, *goal, config.min_clearance_m)) {
    result.status = PlanStatus::kFound;
    result.route = std::move(*route);
  } else {
    set_unreachable(result, shortest_between(map, *start, *goal, 0.0).has_value(), config);
  }
  return result;
}

PlanResult plan_between_nodes(const GlobalMap& map, std::uint32_t from_node, std::uint32_t to_node,
                              const PlanningConfig& config) {
  check(config);
  if (map.branches.empty()) return no_route(PlanStatus::kEmptyMap, "the map has no branches");
  RoadNetwork network(map, config.min_clearance_m);
  for (const std::uint32_t id : {from_node, to_node}) {
    const bool has_branch =
        std::any_of(map.branches.begin(), map.branches.end(),
                    [id](const MapBranch& b) { return b.node_a == id || b.node_b == id; });
    if (!network.vertex(id) || !has_branch) {
      return no_route(PlanStatus::kUnknownNode,
                      fmt::format("the map has no branch at a node {}", id));
    }
  }
  network.connect({});
  PlanResult result;
  if (auto route = network.shortest(*network.vertex(from_node), *network.vertex(to_node))) {
    result.status = PlanStatus::kFound;
    result.route = std::move(*route);
    return result;
  }
  RoadNetwork narrow(map, 0.0);
  narrow.connect({});
  const bool reachable =
      narrow.shortest(*narrow.vertex(from_node), *narrow.vertex(to_node)).has_value();
  set_unreachable(result, reachable, config);
  return result;
}

}  // namespace topogeo::planning
