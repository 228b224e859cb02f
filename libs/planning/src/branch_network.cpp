#include "branch_network.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>

namespace topogeo::planning {
namespace {

using topomap::MapBranch;

// A branch, or its part between ends and cuts.
struct Piece {
  std::size_t branch = 0;  // index in GlobalMap::branches
  std::vector<RoutePoint> points{};
  double length_m = 0.0;
};

struct Track {
  double cost = 0.0;
  std::size_t piece = 0;
  bool backwards = false;
};

using Graph =
    boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property, Track>;
using Vertex = boost::graph_traits<Graph>::vertex_descriptor;

constexpr std::size_t kNoPiece = std::numeric_limits<std::size_t>::max();  // beside the branches

double narrowest_m(const std::vector<RoutePoint>& points) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const RoutePoint& p : points) narrowest = std::min(narrowest, p.clearance_m);
  return narrowest;
}

}  // namespace

struct BranchNetwork::State {
  State(const topomap::GlobalMap& all, double least_m, const BranchRules& obeyed)
      : map(all), min_clearance_m(least_m), rules(obeyed) {
    for (std::size_t i = 0; i < map.nodes.size(); ++i) vertex_of_node[map.nodes[i].id] = i;
  }

  const topomap::GlobalMap& map;
  double min_clearance_m;
  const BranchRules& rules;
  std::map<std::uint32_t, Vertex> vertex_of_node{};
  Graph graph{};
  std::vector<Piece> pieces{};

  // Builds the graph anew. Returns the vertices of the places, in their order; those of the nodes
  // come before.
  std::vector<Vertex> connect(std::span<const BranchPlace> places) {
    graph.clear();
    for (std::size_t i = 0; i < map.nodes.size(); ++i) add_vertex(graph);
    pieces.clear();
    std::vector<Vertex> vertices;
    std::vector<std::vector<std::size_t>> on_branch(map.branches.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      vertices.push_back(add_vertex(graph));
      on_branch[places[i].branch].push_back(i);
    }
    for (std::size_t b = 0; b < map.branches.size(); ++b) {
      std::stable_sort(on_branch[b].begin(), on_branch[b].end(), [&](std::size_t i, std::size_t k) {
        return std::pair(places[i].segment, places[i].along) <
               std::pair(places[k].segment, places[k].along);
      });
      add_branch(b, places, on_branch[b], vertices);
    }
    return vertices;
  }

  void add_branch(std::size_t b, std::span<const BranchPlace> places,
                  const std::vector<std::size_t>& cuts, const std::vector<Vertex>& vertices) {
    const MapBranch& branch = map.branches[b];
    const auto begin = vertex_of_node.find(branch.node_a);
    const auto end = vertex_of_node.find(branch.node_b);
    if (begin == vertex_of_node.end() || end == vertex_of_node.end() || branch.points.empty()) {
      return;
    }
    const auto append = [](Piece& piece, const topomap::BranchPoint& p) {
      piece.points.push_back({p.position_m, p.clearance_m});
    };
    Piece piece{b};
    append(piece, branch.points[0]);
    Vertex last = begin->second;
    std::size_t next = 1;
    for (const std::size_t cut : cuts) {
      for (; next <= places[cut].segment; ++next) append(piece, branch.points[next]);
      piece.points.push_back(places[cut].at);
      add_piece(last, vertices[cut], piece);
      last = vertices[cut];
      piece.points.assign(1, places[cut].at);
    }
    for (; next < branch.points.size(); ++next) append(piece, branch.points[next]);
    add_piece(last, end->second, piece);
  }

  void add_piece(Vertex from, Vertex to, Piece piece) {
    const bool driven = map.branches[piece.branch].is_virtual;
    if (!driven && narrowest_m(piece.points) < min_clearance_m) return;
    BranchRules::Passage whole;
    double cost = 0.0;
    for (std::size_t i = 1; i < piece.points.size(); ++i) {
      const Eigen::Vector2d& a_m = piece.points[i - 1].position_m;
      const Eigen::Vector2d& b_m = piece.points[i].position_m;
      const BranchRules::Passage passage = rules.along(a_m, b_m);
      whole.forth = whole.forth && passage.forth;
      whole.back = whole.back && passage.back;
      const double length_m = (b_m - a_m).norm();
      piece.length_m += length_m;
      cost += length_m * passage.slowness;
    }
    if (driven) cost *= kLastResort;
    if (whole.forth) add_edge(from, to, Track{cost, pieces.size(), false}, graph);
    if (whole.back) add_edge(to, from, Track{cost, pieces.size(), true}, graph);
    pieces.push_back(std::move(piece));
  }

  // The vertices of the path; empty if there is none.
  [[nodiscard]] std::vector<Vertex> cheapest(Vertex from, Vertex to) const {
    std::vector<Vertex> before(num_vertices(graph));
    std::vector<double> cost(num_vertices(graph));
    const auto index = get(boost::vertex_index, graph);
    boost::dijkstra_shortest_paths(
        graph, from,
        boost::weight_map(get(&Track::cost, graph))
            .predecessor_map(boost::make_iterator_property_map(before.begin(), index))
            .distance_map(boost::make_iterator_property_map(cost.begin(), index)));
    if (from != to && before[to] == to) return {};
    std::vector<Vertex> path{to};
    while (path.back() != from) path.push_back(before[path.back()]);
    std::reverse(path.begin(), path.end());
    return path;
  }

  [[nodiscard]] Route route_along(std::span<const Vertex> path) const {
    Route route;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (path[i] < map.nodes.size()) {
        const topomap::MapNode& node = map.nodes[path[i]];
        route.node_ids.push_back(node.id);
        if (route.points.empty()) route.points.push_back({node.position_m, node.clearance_m});
      }
      if (i + 1 < path.size()) follow(cheapest_edge(path[i], path[i + 1]), route);
    }
    route.min_clearance_m = narrowest_m(route.points);
    return route;
  }

  // Two nodes may be joined by several branches.
  [[nodiscard]] Track cheapest_edge(Vertex from, Vertex to) const {
    std::optional<Track> best;
    const auto [begin, end] = out_edges(from, graph);
    for (auto it = begin; it != end; ++it) {
      if (target(*it, graph) != to) continue;
      if (!best || graph[*it].cost < best->cost) best = graph[*it];
    }
    return *best;
  }

  void follow(const Track& track, Route& route) const {
    const Piece& piece = pieces[track.piece];
    std::vector<RoutePoint> points = piece.points;
    if (track.backwards) std::reverse(points.begin(), points.end());
    const MapBranch& branch = map.branches[piece.branch];
    if (route.branch_ids.empty() || route.branch_ids.back() != branch.id) {
      route.branch_ids.push_back(branch.id);
      route.parts.push_back({branch.is_virtual ? PlannedOn::kVirtualBranch : PlannedOn::kBranch,
                             branch.id, route.points.empty() ? 0 : route.points.size() - 1});
    }
    // The first point repeats the end of the last piece.
    const auto skip = static_cast<std::ptrdiff_t>(route.points.empty() ? 0 : 1);
    route.points.insert(route.points.end(), points.begin() + skip, points.end());
    route.length_m += piece.length_m;
  }
};

BranchNetwork::BranchNetwork(const topomap::GlobalMap& map, double min_clearance_m,
                             const BranchRules& rules)
    : state_(std::make_unique<State>(map, min_clearance_m, rules)) {}

BranchNetwork::~BranchNetwork() = default;

std::optional<NetworkPath> BranchNetwork::cheapest(std::span<const BranchAccess> entries,
                                                   std::span<const BranchAccess> exits) {
  State& state = *state_;
  std::vector<BranchPlace> places;
  for (const BranchAccess& entry : entries) places.push_back(entry.place);
  for (const BranchAccess& exit : exits) places.push_back(exit.place);
  const std::vector<Vertex> vertices = state.connect(places);
  const Vertex from = add_vertex(state.graph);
  const Vertex to = add_vertex(state.graph);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    add_edge(from, vertices[i], Track{entries[i].cost, kNoPiece, false}, state.graph);
  }
  for (std::size_t i = 0; i < exits.size(); ++i) {
    add_edge(vertices[entries.size() + i], to, Track{exits[i].cost, kNoPiece, false}, state.graph);
  }
  const std::vector<Vertex> path = state.cheapest(from, to);
  if (path.empty()) return std::nullopt;
  const std::span<const Vertex> inner(path.data() + 1, path.size() - 2);
  NetworkPath found;
  found.from = inner.front() - vertices.front();
  found.to = inner.back() - vertices.front() - entries.size();
  found.route = state.route_along(inner);
  return found;
}

std::optional<Route> BranchNetwork::between_nodes(std::uint32_t from, std::uint32_t to) {
  State& state = *state_;
  state.connect({});
  const std::vector<Vertex> path =
      state.cheapest(state.vertex_of_node.at(from), state.vertex_of_node.at(to));
  if (path.empty()) return std::nullopt;
  return state.route_along(path);
}

}  // namespace topogeo::planning
