// A few drives in a closed loop, from sensors to wheels: the short form of topogeo_arrival.
#include "arrival_run.hpp"

#include <gtest/gtest.h>

namespace topogeo::bench {
namespace {

/// Mapped once for all tests.
const MappedFloor& warehouse() {
  static const MappedFloor floor = map_floor("warehouse", ArrivalConfig{}.system, Wheels::kMild, 7);
  return floor;
}

TEST(Arrival, GetsToGoalsWithinACell) {
  for (const std::uint64_t seed : {1U, 4U, 7U}) {
    ArrivalConfig config;
    config.obstacle_share = 0.0;
    const ArrivalTask task = draw_task(warehouse(), config, seed);
    ASSERT_EQ(task.obstacle, ObstacleKind::kNone);
    const ArrivalResult result = run_arrival(warehouse(), config, task);
    EXPECT_TRUE(result.good()) << "run " << seed << ": " << result.error_m << " m, "
                               << result.heading_error_rad << " rad, " << result.end;
  }
}

TEST(Arrival, TouchesNothingThatIsNotOnTheMap) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    ArrivalConfig config;
    config.obstacle_share = 1.0;
    const ArrivalTask task = draw_task(warehouse(), config, seed);
    ASSERT_NE(task.obstacle, ObstacleKind::kNone);
    const ArrivalResult result = run_arrival(warehouse(), config, task);
    EXPECT_EQ(result.collisions, 0U) << "run " << seed;
    EXPECT_GT(result.path_m, 1.0) << "run " << seed << ": " << result.end;
  }
}

TEST(Arrival, DrivesTheSameAgain) {
  ArrivalConfig config;
  config.longest_s = 20.0;
  const ArrivalTask task = draw_task(warehouse(), config, 5);
  const ArrivalResult first = run_arrival(warehouse(), config, task);
  const ArrivalResult second = run_arrival(warehouse(), config, task);
  EXPECT_EQ(first.error_m, second.error_m);
  EXPECT_EQ(first.path_m, second.path_m);
  EXPECT_EQ(first.end, second.end);
}

}  // namespace
}  // namespace topogeo::bench
