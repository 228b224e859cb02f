// The forward step of PoseGraphSlam deep in a log, and whole logs. Real logs are read from
// TOPOGEO_LOG_DIR, by default ../shared/data beside the source tree; without them their benchmarks
// do not exist.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"

#include "localization/simulated_maps.hpp"

namespace {

using namespace topogeo;
using localization::test::Maps;

std::filesystem::path csail_log() {
  const char* folder = std::getenv("TOPOGEO_LOG_DIR");
  return (folder != nullptr
              ? std::filesystem::path(folder)
              : std::filesystem::path(TOPOGEO_SOURCE_DIR).parent_path() / "shared" / "data") /
         "csail.clf.gz";
}

// Time of PoseGraphSlam::add for the map of `stop`, after all maps before it.
void measure_forward_step(benchmark::State& state, const Maps& maps, std::size_t stop) {
  if (stop >= maps.size()) {
    state.SkipWithError("the log has too few stops");
    return;
  }
  localization::InProcessPool pool;
  localization::PoseGraphSlam before({}, pool);
  for (std::size_t i = 0; i < stop; ++i) before.add(maps[i]);
  const std::uint64_t tasks_before = before.counts().tasks;
  std::uint64_t tasks = 0;
  for (auto _ : state) {
    state.PauseTiming();
    localization::PoseGraphSlam slam = before;
    state.ResumeTiming();
    benchmark::DoNotOptimize(slam.add(maps[stop]));
    state.PauseTiming();
    tasks = slam.counts().tasks - tasks_before;
    state.ResumeTiming();
  }
  state.counters["tasks"] = static_cast<double>(tasks);
}

void forward_synthetic(benchmark::State& state) {
  measure_forward_step(state,
                       localization::test::drive(localization::test::world("floor"), {}).maps, 150);
}

void forward_csail(benchmark::State& state) {
  scan::CarmenLogReader log(csail_log());
  pipeline::LocalMapper mapper({}, "robot");
  constexpr std::size_t kStop = 400;
  Maps maps;
  while (maps.size() <= kStop) {
    const auto scan = log.next();
    if (!scan) break;
    if (auto map = mapper.add(*scan)) {
      maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    }
  }
  measure_forward_step(state, maps, kStop);
}

void map_csail(benchmark::State& state) {
  std::size_t stops = 0;
  for (auto _ : state) {
    scan::CarmenLogReader log(csail_log());
    pipeline::MappingRun run({}, "robot");
    while (const auto scan = log.next()) run.add(*scan);
    stops = run.finish().local_maps.size();
  }
  state.counters["stops"] = static_cast<double>(stops);
}

BENCHMARK(forward_synthetic)->Name("forward/synthetic")->Unit(benchmark::kMillisecond);

[[maybe_unused]] const bool kStepsWithLogs = [] {
  if (!std::filesystem::exists(csail_log())) return false;
  benchmark::RegisterBenchmark("forward/csail", forward_csail)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("map/csail", map_csail)->Unit(benchmark::kSecond)->Iterations(1);
  return true;
}();

}  // namespace
