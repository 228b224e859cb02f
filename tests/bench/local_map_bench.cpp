// Diagram and local map of one scan: 361 beams over 180 degrees, 5 cm cells, in a floor of rooms
// along a corridor seen from a junction. The Thesis took 400-900 ms for the 4 m case on a 400 MHz
// PC.
#include <string>

#include <benchmark/benchmark.h>

#include "topogeo/topomap/local_map_builder.hpp"

#include "voronoi/test_world.hpp"

namespace {

using namespace topogeo;

scan::Scan junction_scan() {
  const test_world::World floor{
      {-2, 1, 2, 1},        {2, 1, 2, 4},       {3, 1, 3, 4},   {3, 1, 12, 1},   {-2, -1, 1, -1},
      {1, -1, 1, -5},       {1, -5, 6, -5},     {6, -5, 6, -1}, {4, -1, 6, -1},  {6.9, -1, 12, -1},
      {6.9, -1, 6.9, -6},   {-2, -1, -2, 1},    {1, 4, 4, 4},   {12, -3, 12, 3}, {3.2, -3, 3.8, -3},
      {3.2, -3, 3.2, -3.6}, {9, 0.4, 9.4, 0.4}, {9, 0.4, 9, 1}};
  return test_world::scan_of(floor, {0.3, -0.1, -0.3});
}

/// Range limit in metres, cell in metres. `with_map` false: the diagram alone.
void perceive(benchmark::State& state, double range_limit_m, double resolution_m, bool with_map) {
  voronoi::VoronoiConfig config;
  config.range_limit_m = range_limit_m;
  config.resolution_m = resolution_m;
  topomap::LocalMapConfig map_config;
  map_config.points_range_m = range_limit_m;
  const scan::Scan scan = junction_scan();
  voronoi::LocalVoronoi voronoi{config};
  voronoi::LocalVoronoiDiagram diagram;
  topomap::LocalMapBuilder builder{map_config};
  topomap::LocalMap map;
  for (auto _ : state) {
    voronoi.compute(scan, diagram);
    if (with_map) builder.build(diagram, scan, {}, map);
    benchmark::DoNotOptimize(diagram.points.data());
    benchmark::DoNotOptimize(map.nodes.data());
  }
  state.counters["cells"] = voronoi.grid().rows() * voronoi.grid().cols();
  state.counters["nodes"] = static_cast<double>(diagram.nodes.size());
  state.counters["branches"] = static_cast<double>(diagram.branches.size());
}

BENCHMARK_CAPTURE(perceive, 4m, 4.0, 0.05, true)
    ->Name("local_map/4m")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(perceive, 10m, 10.0, 0.05, true)
    ->Name("local_map/10m")
    ->Unit(benchmark::kMillisecond);

/// perception_cost/diagram/<range>m/<cell>cm and the same with the local map; perception_cost.sh
/// makes a table of them.
[[maybe_unused]] const bool kRegistered = [] {
  for (const bool with_map : {false, true}) {
    for (const int range_m : {4, 8, 10}) {
      for (const int cell_cm : {2, 5, 10}) {
        const std::string name = std::string("perception_cost/") +
                                 (with_map ? "local_map/" : "diagram/") + std::to_string(range_m) +
                                 "m/" + std::to_string(cell_cm) + "cm";
        benchmark::RegisterBenchmark(name.c_str(), perceive, range_m, 0.01 * cell_cm, with_map)
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
  return true;
}();

}  // namespace
