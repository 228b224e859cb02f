#include "patrol_run.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

namespace topogeo::bench {
namespace {

TEST(Patrol, TheMapStopsGrowingAndFollowsWhatIsMoved) {
  PatrolOptions options;
  // A map that drops no views would have those of eight drives, and the cupboard in both places.
  options.drives = 8;
  options.drives_per_move = 4;
  options.directory = std::filesystem::path(testing::TempDir()) / "topogeo_patrol_test";
  const PatrolResult result = run_patrol(options, pipeline::Config{});
  std::filesystem::remove_all(options.directory);

  ASSERT_EQ(result.drives.size(), options.drives);
  EXPECT_TRUE(result.same_in_store);
  const std::size_t first = result.drives.front().stops;
  for (const PatrolDrive& drive : result.drives) {
    EXPECT_LE(drive.unmapped, first / 4) << drive.drive;
    EXPECT_LT(drive.rms_m, 0.1) << drive.drive;
    EXPECT_LE(drive.map_stops, 6 * first) << drive.drive;
  }
  EXPECT_GT(result.cupboard_cells, 3U);
  EXPECT_EQ(result.ghosts, 0U);
}

}  // namespace
}  // namespace topogeo::bench
