#include "optimization_window.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace topogeo::localization {

namespace {

// Factor beyond the cost at which the rounds are closed, because connected stops yield too.
constexpr double kBeyond = 1.5;

constexpr std::uint32_t kOutside = std::numeric_limits<std::uint32_t>::max();

/// Sets of connected stops of the window.
class Components {
 public:
  explicit Components(std::size_t stops) : parent_(stops, kOutside) {}

  [[nodiscard]] bool contains(std::uint32_t stop) const { return parent_[stop] != kOutside; }
  void add(std::uint32_t stop) { parent_[stop] = stop; }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }
  [[nodiscard]] bool connected(const LoopEnds& ends) {
    return contains(ends.from) && contains(ends.to) && root(ends.from) == root(ends.to);
  }

 private:
  std::uint32_t root(std::uint32_t stop) {
    while (parent_[stop] != stop) stop = parent_[stop] = parent_[parent_[stop]];
    return stop;
  }
  std::vector<std::uint32_t> parent_;
};

std::vector<std::uint32_t> sorted_origins(const PoseGraph& graph,
                                          std::span<const LoopEnds> rounds) {
  std::vector<std::uint32_t> origins{static_cast<std::uint32_t>(graph.poses().size() - 1)};
  for (const LoopEnds& ends : rounds) {
    origins.push_back(ends.from);
    origins.push_back(ends.to);
  }
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return origins;
}

std::vector<std::uint32_t> free_stops(const PoseGraph& graph, std::vector<LoopEnds> rounds,
                                      std::size_t least_stops) {
  std::vector<std::uint32_t> window;
  Components components(graph.poses().size());
  const std::vector<std::uint32_t> origins = sorted_origins(graph, rounds);
  double closed_at = -1.0;
  graph.visit_nearest(origins, [&](std::uint32_t stop, double cost) {
    if (closed_at >= 0.0 && window.size() >= least_stops && cost > kBeyond * closed_at) {
      return false;
    }
    window.push_back(stop);
    components.add(stop);
    for (const std::uint32_t i : graph.edges_at(stop)) {
      const PoseGraphEdge& edge = graph.edges()[i];
      const std::uint32_t other = edge.from == stop ? edge.to : edge.from;
      if (components.contains(other)) components.join(stop, other);
    }
    std::erase_if(rounds, [&](const LoopEnds& ends) { return components.connected(ends); });
    if (rounds.empty() && closed_at < 0.0) closed_at = cost;
    return true;
  });
  std::sort(window.begin(), window.end());
  return window;
}

}  // namespace

GraphProblem whole_problem(const PoseGraph& graph, std::span<const PoseGraphEdge> loops) {
  GraphProblem problem;
  problem.whole = true;
  problem.T_map_robot = graph.poses();
  problem.stops.resize(graph.poses().size());
  std::iota(problem.stops.begin(), problem.stops.end(), 0U);
  problem.held.resize(graph.poses().size());
  if (!problem.held.empty()) problem.held.front() = 1;
  problem.edges = graph.edges();
  problem.edges.insert(problem.edges.end(), loops.begin(), loops.end());
  return problem;
}

GraphProblem window_problem(const PoseGraph& graph, std::span<const PoseGraphEdge> loops,
                            std::span<const LoopEnds> fresh, std::size_t least_stops) {
  const std::size_t stops = graph.poses().size();
  if (stops <= least_stops) return whole_problem(graph, loops);
  std::vector<LoopEnds> rounds(fresh.begin(), fresh.end());
  for (const PoseGraphEdge& loop : loops) rounds.push_back({loop.from, loop.to});
  const std::vector<std::uint32_t> window = free_stops(graph, std::move(rounds), least_stops);
  if (2 * window.size() > stops) return whole_problem(graph, loops);

  GraphProblem problem;
  std::vector<std::uint32_t> index(stops, kOutside);
  std::vector<std::uint32_t> edges;
  problem.stops = window;
  for (const std::uint32_t stop : window) index[stop] = 0;
  for (const std::uint32_t stop : window) {
    for (const std::uint32_t i : graph.edges_at(stop)) {
      const PoseGraphEdge& edge = graph.edges()[i];
      const std::uint32_t other = edge.from == stop ? edge.to : edge.from;
      if (index[other] == kOutside) {
        index[other] = 0;
        problem.stops.push_back(other);
      }
      edges.push_back(i);
    }
  }
  std::sort(problem.stops.begin(), problem.stops.end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (std::uint32_t i = 0; i < problem.stops.size(); ++i) {
    const std::uint32_t stop = problem.stops[i];
    index[stop] = i;
    problem.T_map_robot.push_back(graph.poses()[stop]);
    const bool free = stop != 0 && std::binary_search(window.begin(), window.end(), stop);
    problem.held.push_back(free ? 0 : 1);
  }
  const auto add = [&](PoseGraphEdge edge) {
    edge.from = index[edge.from];
    edge.to = index[edge.to];
    problem.edges.push_back(edge);
  };
  for (const std::uint32_t i : edges) add(graph.edges()[i]);
  for (const PoseGraphEdge& loop : loops) add(loop);
  return problem;
}

}  // namespace topogeo::localization
