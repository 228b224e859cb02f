#include "ridge_refinement.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "components.hpp"

namespace topogeo::topomap {
namespace {

std::vector<std::uint32_t> degrees(const RidgeGraph& graph) {
  std::vector<std::uint32_t> degree(graph.nodes.size(), 0);
  for (const RidgeEdge& e : graph.edges) {
    ++degree[e.a];
    ++degree[e.b];
  }
  return degree;
}

void drop_edges(RidgeGraph& graph, const std::vector<char>& drop) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    if (drop[i] != 0) continue;
    if (kept != i) graph.edges[kept] = std::move(graph.edges[i]);
    ++kept;
  }
  graph.edges.resize(kept);
}

// Mean share over the worst stretch of ten points (a metre at the usual cell side): a detour round
// a standing person is outvoted even if its ends run along a good branch.
double worst_share(const RidgeGraph& graph, const RidgeEdge& edge) {
  constexpr std::size_t kStretch = 10;
  std::vector<double> shares;
  for (const RidgePoint& p : edge.points) shares.push_back(p.share);
  if (shares.empty()) return std::min(graph.nodes[edge.a].share, graph.nodes[edge.b].share);
  const std::size_t stretch = std::min(kStretch, shares.size());
  double sum =
      std::accumulate(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(stretch), 0.0);
  double worst = sum;
  for (std::size_t i = stretch; i < shares.size(); ++i) {
    sum += shares[i] - shares[i - stretch];
    worst = std::min(worst, sum);
  }
  return worst / static_cast<double>(stretch);
}

// Cuts outvoted parts off the free ends.
void trim_ends(RidgeGraph& graph, const GlobalMapConfig& config) {
  const std::vector<std::uint32_t> degree = degrees(graph);
  std::vector<char> drop(graph.edges.size(), 0);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    RidgeEdge& e = graph.edges[i];
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t end = side == 0 ? e.a : e.b;
      if (degree[end] != 1) continue;
      while (drop[i] == 0 && graph.nodes[end].share < config.keep_share) {
        if (e.points.empty()) {
          drop[i] = 1;
        } else if (side == 0) {
          graph.nodes[end] = e.points.front();
          e.points.erase(e.points.begin());
        } else {
          graph.nodes[end] = e.points.back();
          e.points.pop_back();
        }
      }
    }
  }
  drop_edges(graph, drop);
}

// Drops outvoted branches, except the only link between two parts (a door that was closed in most
// views).
void drop_outvoted(RidgeGraph& graph, const GlobalMapConfig& config) {
  Components parts(graph.nodes.size());
  std::vector<std::pair<double, std::size_t>> weak;
  std::vector<char> drop(graph.edges.size(), 0);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const RidgeEdge& e = graph.edges[i];
    const double share = worst_share(graph, e);
    if (share >= config.keep_share) {
      parts.join(e.a, e.b);
    } else {
      weak.emplace_back(-share, i);
    }
  }
  std::sort(weak.begin(), weak.end());
  for (const auto& [negative_share, i] : weak) {
    drop[i] = parts.join(graph.edges[i].a, graph.edges[i].b) ? 0 : 1;
  }
  drop_edges(graph, drop);
}

RidgeEdge reversed(RidgeEdge edge) {
  std::swap(edge.a, edge.b);
  std::reverse(edge.points.begin(), edge.points.end());
  return edge;
}

// Joins the two edges at every node that has exactly two.
void merge_through_nodes(RidgeGraph& graph) {
  std::vector<std::vector<std::size_t>> at(graph.nodes.size());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    at[graph.edges[i].a].push_back(i);
    at[graph.edges[i].b].push_back(i);
  }
  std::vector<char> drop(graph.edges.size(), 0);
  for (std::uint32_t n = 0; n < graph.nodes.size(); ++n) {
    if (at[n].size() != 2 || at[n][0] == at[n][1]) continue;
    const std::size_t keep = at[n][0];
    const std::size_t gone = at[n][1];
    RidgeEdge first = std::move(graph.edges[keep]);
    RidgeEdge second = std::move(graph.edges[gone]);
    if (first.b != n) first = reversed(std::move(first));
    if (second.a != n) second = reversed(std::move(second));
    first.points.push_back(graph.nodes[n]);
    first.points.insert(first.points.end(), second.points.begin(), second.points.end());
    first.b = second.b;
    std::replace(at[second.b].begin(), at[second.b].end(), gone, keep);
    graph.edges[keep] = std::move(first);
    drop[gone] = 1;
    at[n].clear();
  }
  drop_edges(graph, drop);
}

// Drops branches with a free end not far beyond the free circle of their junction. One per junction
// and round, the shortest first, because without it two others can form one long branch.
void prune_spurs(RidgeGraph& graph, const GlobalMapConfig& config) {
  for (;;) {
    const std::vector<std::uint32_t> degree = degrees(graph);
    std::vector<std::pair<double, std::size_t>> spurs;
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      const RidgeEdge& e = graph.edges[i];
      if (e.a != e.b && (degree[e.a] == 1) == (degree[e.b] == 1)) continue;
      const RidgePoint& junction = graph.nodes[degree[e.a] == 1 ? e.b : e.a];
      const double length = length_m(graph, e);
      const double least = e.a == e.b ? 2.0 * config.spur_m : junction.clearance_m + config.spur_m;
      if (length < least) spurs.emplace_back(length, i);
    }
    if (spurs.empty()) return;
    std::sort(spurs.begin(), spurs.end());
    std::vector<char> drop(graph.edges.size(), 0);
    std::vector<char> touched(graph.nodes.size(), 0);
    for (const auto& [length, i] : spurs) {
      const RidgeEdge& e = graph.edges[i];
      char& junction = touched[degree[e.a] == 1 ? e.b : e.a];
      if (junction != 0) continue;
      junction = 1;
      drop[i] = 1;
    }
    drop_edges(graph, drop);
    merge_through_nodes(graph);
  }
}

// Moves everything at `gone` to `kept`, and that midway between them.
void unite_nodes(RidgeGraph& graph, std::uint32_t kept, std::uint32_t gone) {
  RidgePoint& to = graph.nodes[kept];
  const RidgePoint& from = graph.nodes[gone];
  to.position_m = 0.5 * (to.position_m + from.position_m);
  to.clearance_m = 0.5 * (to.clearance_m + from.clearance_m);
  to.views = std::max(to.views, from.views);
  to.last_seen_ns = std::max(to.last_seen_ns, from.last_seen_ns);
  to.first_seen = std::min(to.first_seen, from.first_seen);
  for (RidgeEdge& e : graph.edges) {
    if (e.a == gone) e.a = kept;
    if (e.b == gone) e.b = kept;
  }
}

// Merges two junctions linked by less than the merge distance (fig. 8.10), shortest link first.
void collapse_junctions(RidgeGraph& graph, const GlobalMapConfig& config) {
  for (;;) {
    const std::vector<std::uint32_t> degree = degrees(graph);
    std::optional<std::pair<double, std::size_t>> shortest;
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      const RidgeEdge& e = graph.edges[i];
      if (degree[e.a] < 3 || degree[e.b] < 3) continue;
      if (static_cast<double>(e.points.size()) * 0.5 * config.cell_m > config.node_merge_m)
        continue;
      const double length = length_m(graph, e);
      if (length >= config.node_merge_m || (shortest && shortest->first <= length)) continue;
      shortest.emplace(length, i);
    }
    if (!shortest) return;
    const auto [a, b] = std::pair(graph.edges[shortest->second].a, graph.edges[shortest->second].b);
    graph.edges.erase(graph.edges.begin() + static_cast<std::ptrdiff_t>(shortest->second));
    if (a != b) unite_nodes(graph, std::min(a, b), std::max(a, b));
  }
}

// Keeps only the best supported of several short links between the same two nodes.
void drop_doubles(RidgeGraph& graph, const GlobalMapConfig& config) {
  std::vector<char> drop(graph.edges.size(), 0);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const RidgeEdge& e = graph.edges[i];
    for (std::size_t k = 0; k < i; ++k) {
      const RidgeEdge& other = graph.edges[k];
      if (drop[k] != 0 || std::minmax(e.a, e.b) != std::minmax(other.a, other.b)) continue;
      if (length_m(graph, e) + length_m(graph, other) > 4.0 * config.node_merge_m) continue;
      drop[worst_share(graph, e) > worst_share(graph, other) ? k : i] = 1;
    }
  }
  drop_edges(graph, drop);
}

void drop_small_components(RidgeGraph& graph, const GlobalMapConfig& config) {
  Components parts(graph.nodes.size());
  for (const RidgeEdge& e : graph.edges) parts.join(e.a, e.b);
  std::vector<double> total_m(graph.nodes.size(), 0.0);
  for (const RidgeEdge& e : graph.edges) total_m[parts.root(e.a)] += length_m(graph, e);
  std::vector<char> drop(graph.edges.size(), 0);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    drop[i] = total_m[parts.root(graph.edges[i].a)] < config.min_component_m ? 1 : 0;
  }
  drop_edges(graph, drop);
}

// A place on the graph: a node or a point of an edge.
struct RidgePlace {
  std::size_t edge = 0;
  std::optional<std::size_t> point;  // index in the edge; empty: the node
  std::uint32_t node = 0;
};

struct Gap {
  double distance_m = 0.0;
  std::uint32_t end = 0;
  RidgePlace other;
};

// The nearest place of another part that the free end can reach in a straight line: the line
// between two places is free if their free circles overlap.
std::optional<Gap> nearest_gap(const RidgeGraph& graph, std::uint32_t end, Components& parts,
                               const GlobalMapConfig& config) {
  const RidgePoint& from = graph.nodes[end];
  std::optional<Gap> best;
  const auto look_at = [&](const RidgePoint& to, const RidgePlace& place) {
    const double distance = (to.position_m - from.position_m).norm();
    if (distance > config.join_m || distance > from.clearance_m + to.clearance_m) return;
    if (!best || distance < best->distance_m) best = Gap{distance, end, place};
  };
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const RidgeEdge& e = graph.edges[i];
    if (parts.root(e.a) == parts.root(end)) continue;
    look_at(graph.nodes[e.a], {i, std::nullopt, e.a});
    look_at(graph.nodes[e.b], {i, std::nullopt, e.b});
    for (std::size_t k = 0; k < e.points.size(); ++k) look_at(e.points[k], {i, k, 0});
  }
  return best;
}

// Makes a point of an edge a node and returns it.
std::uint32_t split(RidgeGraph& graph, const RidgePlace& place) {
  if (!place.point) return place.node;
  const auto node = static_cast<std::uint32_t>(graph.nodes.size());
  RidgeEdge& first = graph.edges[place.edge];
  const auto at = first.points.begin() + static_cast<std::ptrdiff_t>(*place.point);
  graph.nodes.push_back(*at);
  RidgeEdge second{node, first.b, {at + 1, first.points.end()}};
  first.points.erase(at, first.points.end());
  first.b = node;
  graph.edges.push_back(std::move(second));
  return node;
}

void close_gaps(RidgeGraph& graph, const GlobalMapConfig& config) {
  for (;;) {
    Components parts(graph.nodes.size());
    for (const RidgeEdge& e : graph.edges) parts.join(e.a, e.b);
    const std::vector<std::uint32_t> degree = degrees(graph);
    std::optional<Gap> best;
    for (std::uint32_t n = 0; n < graph.nodes.size(); ++n) {
      if (degree[n] != 1) continue;
      const std::optional<Gap> gap = nearest_gap(graph, n, parts, config);
      if (gap && (!best || gap->distance_m < best->distance_m)) best = gap;
    }
    if (!best) return;
    const std::uint32_t other = split(graph, best->other);
    graph.edges.push_back({best->end, other, {}});
  }
}

}  // namespace

double length_m(const RidgeGraph& graph, const RidgeEdge& edge) {
  double length = 0.0;
  Eigen::Vector2d last = graph.nodes[edge.a].position_m;
  for (const RidgePoint& p : edge.points) {
    length += (p.position_m - last).norm();
    last = p.position_m;
  }
  return length + (graph.nodes[edge.b].position_m - last).norm();
}

RidgeGraph refine_ridge(RidgeGraph graph, const GlobalMapConfig& config) {
  trim_ends(graph, config);
  merge_through_nodes(graph);
  drop_outvoted(graph, config);
  trim_ends(graph, config);
  merge_through_nodes(graph);
  prune_spurs(graph, config);
  collapse_junctions(graph, config);
  drop_doubles(graph, config);
  merge_through_nodes(graph);
  close_gaps(graph, config);
  merge_through_nodes(graph);
  drop_small_components(graph, config);
  return graph;
}

}  // namespace topogeo::topomap
