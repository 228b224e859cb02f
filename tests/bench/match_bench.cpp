// Matching of two local maps seen 0.5 m apart on the simulated floor:
// match/KxG   one match of K individuals and G generations, refinement included: the cost of a task
//             in the search pool. The Thesis took 10-30 s for 100 x 50 on a 400 MHz PC.
// verify      the check of an answer, which the client of a pool does for each.
// reference   the look-up grids of a map, made when a match or a check is the first to refer to it.
#include <cstdint>
#include <memory>

#include <benchmark/benchmark.h>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace {

using namespace topogeo;

struct Pair {
  Pair() {
    matcher.add_map(reference);
    matcher.add_map(query);
  }

  topomap::LocalMap reference = map_at({8.6, 1.2, 0.1}, 0);
  topomap::LocalMap query = map_at({9.1, 1.2, 0.4}, 1);
  localization::Matcher matcher;
  // Assumed knowledge of odometry after a path of 0.5 m and a turn of 0.3 rad.
  localization::MatchTask task =
      localization::test::task_between(reference, query, {0.6, 0.05, 0.25}, 0.10, 0.18);

 private:
  static topomap::LocalMap map_at(const geometry::Pose2& T_world_robot, std::uint32_t id) {
    static const world::World floor = localization::test::world("floor");
    return localization::test::map_at(floor, T_world_robot, id);
  }
};

void match(benchmark::State& state, std::uint32_t individuals, std::uint32_t generations) {
  Pair pair;
  pair.task.genetic.individuals = individuals;
  pair.task.genetic.generations = generations;
  localization::MatchResult result;
  for (auto _ : state) {
    ++pair.task.seed;
    result = pair.matcher.solve(pair.task);
    benchmark::DoNotOptimize(result.T_reference_query);
  }
  state.counters["evaluations"] = result.evaluations;
}

void verify(benchmark::State& state) {
  Pair pair;
  const localization::MatchResult answer = pair.matcher.solve(pair.task);
  for (auto _ : state) {
    if (!pair.matcher.verify(pair.task, answer).empty()) state.SkipWithError("refused");
  }
}

void reference(benchmark::State& state) {
  Pair pair;
  const auto features = std::make_shared<const localization::MatchFeatures>(
      localization::extract_features(pair.reference));
  localization::Reference made;
  for (auto _ : state) {
    localization::remake_reference(features, made);
    benchmark::DoNotOptimize(made.surfaces.data());
  }
  state.counters["points"] = static_cast<double>(features->surface.size());
  state.counters["branch_points"] = static_cast<double>(features->branches.size());
}

BENCHMARK_CAPTURE(match, 100x50, 100, 50)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(match, 50x30, 50, 30)->Unit(benchmark::kMillisecond);
BENCHMARK(verify)->Unit(benchmark::kMicrosecond);
BENCHMARK(reference)->Unit(benchmark::kMicrosecond);

}  // namespace
