// Routes on a floor of 200 x 200 m (2,000 x 2,000 cells, 200 drawn zones, six pieces of furniture
// in each), through a graph of 10,000 nodes, and round obstacles.
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/local_detour.hpp"
#include "topogeo/planning/route_graph.hpp"
#include "topogeo/support/random.hpp"

#include "planning/floors.hpp"

namespace {

using namespace topogeo;
using namespace topogeo::planning;

constexpr std::uint64_t kSeed = 2000;

struct Query {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

class LargeFloor {
 public:
  LargeFloor() : floor_(block_floor({20, 10, 100, 200, 10, 6}, kSeed)), space_(floor_.grid) {
    support::Random random(kSeed);
    constexpr int kQueries = 51;
    for (int k = 0; k < kQueries; ++k) {
      const Eigen::Vector2d from_m = random_free_point_m(space_, random);
      queries_.push_back({from_m, random_free_point_m(space_, random)});
    }
  }

  [[nodiscard]] HybridMap map() const { return {space_, drawn_zones(space_, floor_.rooms)}; }
  [[nodiscard]] const FreeSpace& space() const { return space_; }
  [[nodiscard]] const std::vector<Query>& queries() const { return queries_; }

 private:
  BlockFloor floor_;
  FreeSpace space_;
  std::vector<Query> queries_;
};

const LargeFloor& large_floor() {
  static const LargeFloor floor;
  return floor;
}

// Runs one query after the other, so that the median over repetitions is that of a usual one.
void plan_hybrid(benchmark::State& state) {
  static const HybridMap map = large_floor().map();
  const HybridPlanner planner(map);
  std::size_t next = 0;
  for (auto _ : state) {
    const Query& query = large_floor().queries()[next];
    benchmark::DoNotOptimize(planner.plan(query.from_m, query.to_m));
    next = (next + 1) % large_floor().queries().size();
  }
  state.counters["zones"] = static_cast<double>(map.zones().zones.size());
  state.counters["nodes"] = static_cast<double>(map.nodes().size());
}
BENCHMARK(plan_hybrid)->Name("plan/hybrid_2000")->Unit(benchmark::kMillisecond);

void plan_astar(benchmark::State& state) {
  std::size_t next = 0;
  for (auto _ : state) {
    const Query& query = large_floor().queries()[next];
    benchmark::DoNotOptimize(plan_on_grid(large_floor().space(), query.from_m, query.to_m));
    next = (next + 1) % large_floor().queries().size();
  }
}
BENCHMARK(plan_astar)->Name("plan/astar_2000")->Unit(benchmark::kMillisecond);

void plan_build(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(large_floor().map());
}
BENCHMARK(plan_build)->Name("plan/build_2000")->Unit(benchmark::kMillisecond);

// A hundred by a hundred crossings, with roads of random length between neighbours.
void plan_graph(benchmark::State& state) {
  constexpr std::uint32_t kSide = 100;
  support::Random random(kSeed);
  std::vector<GraphEdge> edges;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t node = y * kSide + x;
      if (x + 1 < kSide) edges.push_back({node, node + 1, random.uniform(1.0, 2.0)});
      if (y + 1 < kSide) edges.push_back({node, node + kSide, random.uniform(1.0, 2.0)});
    }
  }
  const RouteGraph graph(std::size_t{kSide} * kSide, edges);
  for (auto _ : state) {
    const auto node = [&random] {
      return static_cast<std::uint32_t>(random.below(std::uint64_t{kSide} * kSide));
    };
    const std::vector<GraphAccess> entries{{node(), 0.0}};
    const std::vector<GraphAccess> exits{{node(), 0.0}};
    benchmark::DoNotOptimize(graph.cheapest(entries, exits));
  }
}
BENCHMARK(plan_graph)->Name("plan/graph_10000")->Unit(benchmark::kMillisecond);

// A robot that drives through a floor of 60 x 40 m gets half a second of laser data: the furniture
// round it again and a box ahead.
void plan_detour_round_box(benchmark::State& state) {
  static const BlockFloor floor = block_floor({12, 10, 50, 40, 10, 2}, kSeed);
  static const FreeSpace space(floor.grid);
  support::Random random(kSeed);
  HybridRoute route;
  while (route.length_m < 40.0) {
    const Eigen::Vector2d from_m = random_free_point_m(space, random);
    route = plan_on_grid(space, from_m, random_free_point_m(space, random));
  }
  const std::size_t at = route.cells.size() / 8;
  const Eigen::Vector2d robot_m = space.frame().center_m(route.cells[at]);
  const Eigen::Vector2d box_m = space.frame().center_m(route.cells[at + 15]);
  std::vector<Eigen::Vector2d> seen_m;
  for (const Cell& cell : route.cells) {
    for (std::int32_t k = -30; k <= 30 && seen_m.size() < 300; k += 3) {
      const Cell near{cell.column + k, cell.row - k};
      if (space.frame().contains(near) && space.grid().at(near) == CellState::kOccupied) {
        seen_m.push_back(space.frame().center_m(near));
      }
    }
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 20; ++column) {
      seen_m.push_back(box_m + Eigen::Vector2d(0.01 * column - 0.1, 0.05 * row - 0.05));
    }
  }
  DetourStatus status = DetourStatus::kLost;
  for (auto _ : state) {
    const Detour detour = plan_detour(space, route.cells, robot_m, route.points_m.back(), seen_m);
    status = detour.status;
    benchmark::DoNotOptimize(detour.cells.data());
  }
  if (status != DetourStatus::kFound) state.SkipWithError("there is no detour");
  state.counters["points"] = static_cast<double>(seen_m.size());
  state.counters["route_m"] = route.length_m;
}
BENCHMARK(plan_detour_round_box)->Name("plan/detour")->Unit(benchmark::kMillisecond);

// The floor of 200 x 200 m with obstacles in 40 of its doors and on the route.
void plan_closed(benchmark::State& state) {
  static const HybridMap map = large_floor().map();
  const HybridPlanner planner(map);
  support::Random random(kSeed);
  Closures closed;
  constexpr int kThings = 40;
  for (int k = 0; k < kThings; ++k) {
    const Cell at = map.nodes()[random.below(map.nodes().size())].cells[0];
    for (std::int32_t x = 0; x < 4; ++x) closed.cells.push_back({at.column + x, at.row});
  }
  std::size_t next = 0;
  for (auto _ : state) {
    const Query& query = large_floor().queries()[next];
    benchmark::DoNotOptimize(planner.plan(query.from_m, query.to_m, closed));
    next = (next + 1) % large_floor().queries().size();
  }
}
BENCHMARK(plan_closed)->Name("plan/closed_2000")->Unit(benchmark::kMillisecond);

}  // namespace
