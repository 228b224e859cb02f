// Patience of 4 s, reports after 4.3 s, a planner that may take 5 s.
#include "obstacle_wait.hpp"

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

TEST(ObstacleWait, WaitsThenReportsThenCallsThePlannerLate) {
  ObstacleWait wait{ObstacleWaitConfig{}};
  EXPECT_FALSE(wait.waits());
  EXPECT_FALSE(wait.over(100 * kSecond_ns));
  wait.begin(10 * kSecond_ns, 1.0);
  wait.begin(13 * kSecond_ns, 1.0);  // it is waiting already
  EXPECT_TRUE(wait.waits());
  EXPECT_EQ(wait.reason(), HaltReason::kObstacle);
  EXPECT_EQ(wait.message("a box", 13 * kSecond_ns),
            "a box; waits 1 s, then looks for another route");
  EXPECT_FALSE(wait.over(13 * kSecond_ns));
  EXPECT_TRUE(wait.over(14 * kSecond_ns));
  EXPECT_FALSE(wait.report_due(14 * kSecond_ns));
  EXPECT_TRUE(wait.report_due(15 * kSecond_ns));
  wait.set_reported(15 * kSecond_ns);
  EXPECT_FALSE(wait.report_due(16 * kSecond_ns));
  EXPECT_EQ(wait.reason(), HaltReason::kWaitsForRoute);
  EXPECT_EQ(wait.message("a box", 16 * kSecond_ns), "a box; requests another route");
  EXPECT_EQ(wait.message("a box", 22 * kSecond_ns), "a box; the planner has not answered for 7 s");
}

TEST(ObstacleWait, EndsWhenTheRobotHasDrivenOn) {
  ObstacleWait wait{ObstacleWaitConfig{}};
  wait.begin(0, 1.0);
  wait.set_reported(5 * kSecond_ns);
  wait.drive_on(1.05);  // the last bit up to the obstacle
  EXPECT_TRUE(wait.waits());
  wait.drive_on(1.2);
  EXPECT_FALSE(wait.waits());
  EXPECT_FALSE(wait.reported());
}

TEST(ObstacleWait, KeepsWhatWasReportedWhenItOnlyStopsWaiting) {
  ObstacleWait wait{ObstacleWaitConfig{}};
  wait.begin(0, 1.0);
  wait.set_reported(5 * kSecond_ns);
  wait.end();
  EXPECT_FALSE(wait.waits());
  EXPECT_TRUE(wait.reported());
  wait.forget();
  EXPECT_FALSE(wait.reported());
}

}  // namespace
}  // namespace topogeo::navigation
