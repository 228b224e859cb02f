// Diagram and local map of one scan: 361 beams over 180 degrees, 5 cm cells, in a floor of rooms
// along a corridor seen from a junction. The source took 400-900 ms for the 4 m case on a 400 MHz
// PC.
#include <benchmark/benchmark.h>

#include "topogeo/topomap/local_map_builder.hpp"

#include "../unit/voronoi/test_world.hpp"

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

void local_map(benchmark::State& state, double range_limit_m) {
  voronoi::VoronoiConfig config;
  config.range_limit_m = range_limit_m;
  topomap::LocalMapConfig map_config;
  map_config.range_limit_m = range_limit_m;
  const scan::Scan scan = junction_scan();
  voronoi::LocalVoronoi voronoi{config};
  voronoi::LocalVoronoiDiagram diagram;
  topomap::LocalMap map;
  for (auto _ : state) {
    voronoi.compute(scan, diagram);
    topomap::build_local_map(diagram, scan, {}, map_config, map);
    benchmark::DoNotOptimize(map.nodes.data());
  }
  state.counters["nodes"] = static_cast<double>(diagram.nodes.size());
  state.counters["branches"] = static_cast<double>(map.branches.size());
}

BENCHMARK_CAPTURE(local_map, 4m, 4.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(local_map, 10m, 10.0)->Unit(benchmark::kMillisecond);

}  // namespace
