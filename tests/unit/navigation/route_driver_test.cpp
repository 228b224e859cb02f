// A robot on a route across a room of 8 x 6 m.
#include "route_driver.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "post_scan.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

class RouteDriverTest : public testing::Test {
 protected:
  RouteDriverTest() {
    routes.set_map(map_of(room()), 1);
    RoutePlan route;
    route.map_version = 1;
    route.found = true;
    route.points_m = {{1.0, 3.0}, {7.0, 3.0}};
    routes.offer(route);
    routes.take_offer({});
  }

  [[nodiscard]] RouteDriver::Scene scene(std::int64_t now_ns, double x_m = 1.0) const {
    return {routes, {x_m, 3.0, 0.0}, obstacles, waited, now_ns};
  }
  void stand_in_the_way(double x_m) {
    obstacles.points_m = {{x_m, 2.9}, {x_m, 3.0}, {x_m, 3.1}};
    obstacles.standing = obstacles.points_m.size();
  }

  NavigatorConfig config;
  RouteKeeper routes;
  SeenObstacles obstacles;
  bool waited = false;
  RouteDriver driver{config};
};

TEST_F(RouteDriverTest, DrivesAlongAPathThatItHasFound) {
  driver.need_path();
  driver.doubt_route();
  ASSERT_TRUE(driver.find_path(scene(kSecond_ns)));
  EXPECT_FALSE(driver.needs_path());
  EXPECT_FALSE(driver.doubts_route());
  EXPECT_EQ(driver.take_detours().all, 0U);
  const RouteDriver::Step step = driver.follow(scene(kSecond_ns), false);
  EXPECT_GT(step.follower.command.linear_m_per_s, 0.0);
  EXPECT_FALSE(step.another_path);
  EXPECT_FALSE(driver.block());
}

TEST_F(RouteDriverTest, GoesRoundWhatStandsInItsPath) {
  ASSERT_TRUE(driver.find_path(scene(kSecond_ns)));
  stand_in_the_way(3.0);
  EXPECT_FALSE(driver.follow(scene(kSecond_ns), false).another_path);  // it has just planned
  EXPECT_TRUE(driver.block());
  EXPECT_EQ(driver.describe_block().find("something is in the way 1.7 m ahead"), 0U);
  const RouteDriver::Step step = driver.follow(scene(2 * kSecond_ns), false);
  EXPECT_TRUE(step.another_path);
  EXPECT_FALSE(driver.block());
  EXPECT_EQ(driver.take_detours().all, 1U);
  EXPECT_EQ(driver.take_detours().all, 0U);
}

TEST_F(RouteDriverTest, StopsBeforeWhatMovesInItsPath) {
  ASSERT_TRUE(driver.find_path(scene(kSecond_ns)));
  stand_in_the_way(1.4);
  obstacles.standing = 0;
  const RouteDriver::Step step = driver.follow(scene(2 * kSecond_ns), false);
  EXPECT_FALSE(step.another_path);
  EXPECT_TRUE(step.before_block);
  EXPECT_LT(step.follower.command.linear_m_per_s, 0.05);
}

TEST_F(RouteDriverTest, SearchesAnotherPathWhenTheGuardHoldsIt) {
  ASSERT_TRUE(driver.find_path(scene(kSecond_ns)));
  EXPECT_TRUE(driver.just_planned(kSecond_ns));
  EXPECT_FALSE(driver.follow(scene(kSecond_ns), true).another_path);
  EXPECT_FALSE(driver.just_planned(2 * kSecond_ns));
  EXPECT_TRUE(driver.follow(scene(2 * kSecond_ns), true).another_path);
}

TEST_F(RouteDriverTest, IsAstrayFarOffItsPath) {
  EXPECT_FALSE(driver.astray({1.0, 5.0}));  // it has none
  ASSERT_TRUE(driver.find_path(scene(kSecond_ns)));
  EXPECT_FALSE(driver.astray({2.0, 3.3}));
  EXPECT_FALSE(driver.needs_path());
  EXPECT_TRUE(driver.astray({2.0, 4.0}));
  EXPECT_TRUE(driver.needs_path());
  driver.trust_route();
  EXPECT_FALSE(driver.astray({2.0, 4.0}));  // it still returns to its route
}

}  // namespace
}  // namespace topogeo::navigation
