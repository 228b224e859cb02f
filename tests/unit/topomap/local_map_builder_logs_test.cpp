// Local maps of recorded logs.
#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

#include "recorded_logs.hpp"

namespace topogeo::topomap {
namespace {

TEST(LocalMapBuilderLogs, MostScansGiveARealBranch) {
  if (recorded_logs().empty()) GTEST_SKIP() << "no logs in ../shared/data or TOPOGEO_LOG_DIR";
  for (const auto& path : recorded_logs()) {
    scan::CarmenLogReader reader(path);
    voronoi::LocalVoronoi voronoi{voronoi::VoronoiConfig{}};
    voronoi::LocalVoronoiDiagram diagram;
    LocalMap map;
    int scans = 0;
    int with_branch = 0;
    int with_node = 0;
    while (const auto scan = reader.next()) {
      voronoi.compute(*scan, diagram);
      build_local_map(diagram, *scan, {}, {}, map);
      ++scans;
      with_branch += std::ranges::any_of(
          map.branches, [](const LocalBranch& branch) { return !branch.is_virtual; });
      with_node += std::ranges::any_of(
          map.nodes, [](const LocalNode& node) { return node.kind == NodeKind::kReal; });
    }
    std::printf("%s: %d scans, %.2f with a branch, %.2f with a real node\n",
                path.filename().c_str(), scans, with_branch / static_cast<double>(scans),
                with_node / static_cast<double>(scans));
    EXPECT_GE(with_branch, 0.8 * scans) << path;
  }
}

}  // namespace
}  // namespace topogeo::topomap
