// Paths along a route across a room of 8 x 6 m.
#include "local_planner.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/navigation/path_follower.hpp"

#include "path_distance.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

class LocalPlannerTest : public testing::Test {
 protected:
  LocalPlannerTest() {
    routes.set_map(map_of(room()), 1);
    RoutePlan route;
    route.map_version = 1;
    route.found = true;
    route.points_m = {{1.0, 3.0}, {7.0, 3.0}};
    routes.offer(route);
    routes.take_offer({});
  }

  NavigatorConfig config;
  RouteKeeper routes;
  LocalPlanner planner{config};
};

TEST_F(LocalPlannerTest, FollowsTheRouteWhereNothingIsInItsWay) {
  const LocalPath local = planner.plan(routes, {1.0, 3.0}, {});
  EXPECT_EQ(local.status, planning::DetourStatus::kClear);
  ASSERT_FALSE(local.path.empty());
  EXPECT_NEAR(local.path.back().distance_m, 6.0, 0.05);
  EXPECT_LT((local.path.back().T_map_robot.position_m() - routes.goal_m()).norm(), 1e-9);
}

TEST_F(LocalPlannerTest, LeadsRoundAnObstacle) {
  const std::vector<Eigen::Vector2d> obstacles_m = {{3.0, 2.9}, {3.0, 3.0}, {3.0, 3.1}};
  const LocalPath local = planner.plan(routes, {1.5, 3.0}, obstacles_m);
  EXPECT_EQ(local.status, planning::DetourStatus::kFound);
  ASSERT_FALSE(local.path.empty());
  for (const Eigen::Vector2d& obstacle_m : obstacles_m) {
    EXPECT_GT(distance_m(local.path, obstacle_m), config.guard.radius_m);
  }
  EXPECT_FALSE(planner.blocked(local.path, 0.0, {1.5, 3.0}, obstacles_m, 10.0));
}

TEST_F(LocalPlannerTest, GoesStraightToAGoalThatIsNear) {
  const LocalPath local = planner.plan(routes, {6.8, 3.0}, {});
  EXPECT_EQ(local.status, planning::DetourStatus::kClear);
  EXPECT_NEAR(local.path.back().distance_m, 0.2, 1e-9);
}

TEST_F(LocalPlannerTest, FindsTheFirstPlaceThatIsBlocked) {
  const std::vector<planning::PathSample> path = straight_path(routes.route().points_m);
  const std::vector<Eigen::Vector2d> obstacles_m = {{5.0, 3.0}, {4.0, 3.1}};
  const auto block = planner.blocked(path, 1.0, {2.0, 3.0}, obstacles_m, 5.0);
  ASSERT_TRUE(block);
  EXPECT_EQ(block->obstacle_m, obstacles_m[1]);
  EXPECT_NEAR(block->ahead_m, 2.0 - config.guard.radius_m, 0.06);
  EXPECT_FALSE(planner.blocked(path, 1.0, {2.0, 3.0}, obstacles_m, 1.0));  // beyond its reach
  // Obstacles well beside the path do not block it, nor do those that the robot moves away from.
  EXPECT_FALSE(planner.blocked(path, 1.0, {2.0, 3.0}, {{{4.0, 3.5}}}, 5.0));
  EXPECT_FALSE(planner.blocked(path, 1.0, {2.0, 3.0}, {{{1.75, 3.0}}}, 5.0));
}

TEST_F(LocalPlannerTest, ReportsAPathThroughAWallAsNotPassable) {
  const planning::FreeSpace& space = routes.map()->space();
  EXPECT_TRUE(passable(space, straight_path(routes.route().points_m), 0.0));
  const std::vector<Eigen::Vector2d> out_m = {{6.0, 3.0}, {9.0, 3.0}};
  EXPECT_FALSE(passable(space, straight_path(out_m), 0.0));
  EXPECT_TRUE(passable(space, straight_path(out_m), 2.7));  // at most half a metre is left
}

}  // namespace
}  // namespace topogeo::navigation
