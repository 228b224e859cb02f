// A few drives with sonars alone: the short form of topogeo_sonar_arrival.
#include "sonar_run.hpp"

#include <gtest/gtest.h>

namespace topogeo::bench {
namespace {

TEST(SonarArrival, GetsFromTheBaseStationToGoalsWithinACell) {
  for (const int sonars : {24, 6}) {
    SonarDriveConfig config = sonar_drive_config();
    config.sonars = sonars;
    const DrawnFloor rooms = draw_floor("rooms", config.system.hybrid_map);
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const SonarTask task = draw_sonar_task(rooms, config, seed);
      const SonarResult result = run_sonar_drive(rooms, config, task);
      EXPECT_TRUE(result.good()) << sonars << " sonars, drive " << seed << ": " << result.error_m
                                 << " m, " << result.collisions << " collisions, " << result.end;
    }
  }
}

TEST(SonarArrival, DrivesTheSameAgain) {
  SonarDriveConfig config = sonar_drive_config();
  config.wheels = Wheels::kB21;
  config.longest_s = 20.0;
  const DrawnFloor rooms = draw_floor("rooms", config.system.hybrid_map);
  const SonarTask task = draw_sonar_task(rooms, config, 5);
  const SonarResult first = run_sonar_drive(rooms, config, task);
  const SonarResult second = run_sonar_drive(rooms, config, task);
  EXPECT_EQ(first.error_m, second.error_m);
  EXPECT_EQ(first.path_m, second.path_m);
  EXPECT_GT(first.path_m, 0.5);
}

}  // namespace
}  // namespace topogeo::bench
