// An unknown pose in the finished map of csail, by one scan and in one process. The log is looked
// for as in slam_bench.cpp.
#include <cstdlib>
#include <filesystem>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/relocalization/global_localization.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

namespace {

using namespace topogeo;

std::filesystem::path csail_file() {
  const char* folder = std::getenv("TOPOGEO_LOG_DIR");
  return (folder != nullptr
              ? std::filesystem::path(folder)
              : std::filesystem::path(TOPOGEO_SOURCE_DIR).parent_path() / "shared" / "data") /
         "csail.clf.gz";
}

void relocalize_csail(benchmark::State& state) {
  scan::CarmenLogReader log(csail_file());
  const pipeline::Config config;
  pipeline::MappingRun run(config, "robot");
  std::vector<std::vector<topomap::ScanPoint>> scans;
  for (std::size_t i = 0; const auto scan = log.next(); ++i) {
    run.add(*scan);
    constexpr std::size_t kEvery = 37;
    if (i % kEvery == 0) {
      scans.push_back(
          topomap::scan_points(*scan, {}, config.local_mapper.local_map.points_range_m));
    }
  }
  const storage::MapDocument map = run.finish();
  const localization::GlobalLocalizer localizer(map.local_maps, map.trajectory);
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(localizer.find(scans[next], {}));
    next = (next + 1) % scans.size();
  }
}

[[maybe_unused]] const bool kWithLogs = [] {
  if (!std::filesystem::exists(csail_file())) return false;
  benchmark::RegisterBenchmark("relocalize/csail", relocalize_csail)->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
