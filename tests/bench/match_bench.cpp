// One match of two local maps seen 0.5 m apart on the simulated floor, refinement included: what a
// task of the search pool costs. The Thesis took 10-30 s for 100 x 50 on a 400 MHz PC.
#include <benchmark/benchmark.h>

#include "topogeo/localization/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace {

using namespace topogeo;

void match(benchmark::State& state, std::uint32_t individuals, std::uint32_t generations) {
  const world::World floor = localization::test::world("floor");
  const topomap::LocalMap reference = localization::test::map_at(floor, {8.6, 1.2, 0.1}, 0);
  const topomap::LocalMap query = localization::test::map_at(floor, {9.1, 1.2, 0.4}, 1);
  localization::Matcher matcher;
  matcher.add_map(reference);
  matcher.add_map(query);
  // What odometry is taken to know after a path of 0.5 m and a turn of 0.3 rad.
  localization::MatchTask task =
      localization::test::task_between(reference, query, {0.6, 0.05, 0.25}, 0.10, 0.18);
  task.genetic.individuals = individuals;
  task.genetic.generations = generations;
  localization::MatchResult result;
  for (auto _ : state) {
    ++task.seed;
    result = matcher.solve(task);
    benchmark::DoNotOptimize(result.T_reference_query);
  }
  state.counters["evaluations"] = result.evaluations;
}

BENCHMARK_CAPTURE(match, 100x50, 100, 50)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(match, 50x30, 50, 30)->Unit(benchmark::kMillisecond);

}  // namespace
