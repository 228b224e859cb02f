// Routes across a room of 8 x 6 m: offered, accepted, refused, waited for.
#include "route_keeper.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "topogeo/navigation/path_follower.hpp"

#include "path_distance.hpp"
#include "post_scan.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

RoutePlan route_across(double y_m, std::uint64_t map_version = 1) {
  RoutePlan route;
  route.map_version = map_version;
  route.found = true;
  route.points_m = {{1.0, y_m}, {7.0, y_m}};
  return route;
}

/// The room with a wall across it at x = 4 m that leaves 1 m free at its upper end.
world::World walled_room() {
  world::World world = room();
  world.segments.push_back({{4.0, 0.0}, {4.0, 5.0}});
  return world;
}

TEST(RouteKeeper, TakesARouteThatIsFound) {
  RouteKeeper routes;
  routes.set_map(map_of(room()), 1);
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kKept);
  EXPECT_FALSE(routes.has_route());
  routes.offer(route_across(3.0));
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kTaken);
  ASSERT_TRUE(routes.has_route());
  EXPECT_EQ(routes.goal_m(), Eigen::Vector2d(7.0, 3.0));
  EXPECT_GE(routes.cells().size(), 59U);  // 6 m of cells of 10 cm
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kKept);
  routes.cancel();
  EXPECT_FALSE(routes.has_route());
}

TEST(RouteKeeper, ARefusalEndsTheRouteInHand) {
  RouteKeeper routes;
  routes.set_map(map_of(room()), 1);
  routes.offer(route_across(3.0));
  routes.take_offer({});
  RoutePlan none;
  none.map_version = 1;
  none.reason = "the goal is outside of the grid";
  routes.offer(none);
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kRefused);
  EXPECT_FALSE(routes.has_route());
  EXPECT_EQ(routes.refused(), none.reason);
  routes.expect(kSecond_ns);
  EXPECT_TRUE(routes.refused().empty());
}

TEST(RouteKeeper, WaitsForTheMapAndForTheBlockages) {
  RouteKeeper routes;
  routes.set_map(map_of(room()), 1);
  routes.offer(route_across(3.0, 2));
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kKept);
  RouteKeeper::Use use;
  use.least_blockages_version = 3;
  routes.set_map(map_of(room()), 2);
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kKept);
  RoutePlan avoids = route_across(3.0, 2);
  avoids.blockages_version = 3;
  routes.offer(avoids);
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kTaken);
}

TEST(RouteKeeper, ARouteOfAnOlderMapMustHaveRoomInTheNewOne) {
  RouteKeeper routes;
  routes.set_map(map_of(walled_room()), 2);
  routes.offer(route_across(3.0));
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kKept);
  routes.offer(route_across(5.5));
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kTaken);
}

TEST(RouteKeeper, TheSameRouteAgainChangesNothingForARobotOnIt) {
  RouteKeeper routes;
  routes.set_map(map_of(room()), 1);
  routes.offer(route_across(3.0));
  routes.take_offer({});
  const std::vector<planning::PathSample> path = straight_path(routes.route().points_m);
  RouteKeeper::Use use;
  use.path = path;
  RoutePlan shorter = route_across(3.0);
  shorter.points_m.front().x() = 2.0;
  routes.offer(shorter);
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kKept);
  EXPECT_EQ(routes.route().points_m.front().x(), 2.0);  // it is still the one in hand
  RoutePlan round = route_across(3.0);
  round.points_m.insert(round.points_m.begin() + 1, {4.0, 4.0});
  routes.offer(round);
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kTaken);
  routes.offer(route_across(4.0));
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kTaken);  // another goal
}

TEST(RouteKeeper, ARobotThatSettlesAtTheGoalKeepsItsRoute) {
  RouteKeeper routes;
  routes.set_map(map_of(room()), 1);
  routes.offer(route_across(3.0));
  routes.take_offer({});
  RouteKeeper::Use use;
  use.settles = true;
  routes.offer(route_across(3.0));
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kKept);
  RoutePlan turned = route_across(3.0);
  turned.heading_rad = 1.0;
  routes.offer(turned);
  EXPECT_EQ(routes.take_offer(use), RouteAnswer::kTaken);
}

TEST(RouteKeeper, AGoalOfAnUnknownTimeIsWaitedForFromTheFirstQuestion) {
  RouteKeeper routes;
  routes.expect(0);
  EXPECT_DOUBLE_EQ(routes.waited_s(1'000'000 * kSecond_ns), 0.0);
  EXPECT_DOUBLE_EQ(routes.waited_s(1'000'003 * kSecond_ns), 3.0);
}

TEST(RouteKeeper, CountsTheTimeThatItWaits) {
  RouteKeeper routes;
  routes.expect(10 * kSecond_ns);
  EXPECT_DOUBLE_EQ(routes.waited_s(12 * kSecond_ns), 2.0);
  EXPECT_DOUBLE_EQ(routes.wait_s(15 * kSecond_ns), 0.0);
  EXPECT_DOUBLE_EQ(routes.wait_s(18 * kSecond_ns), 3.0);
  routes.stop_waiting();
  EXPECT_DOUBLE_EQ(routes.waited_s(18 * kSecond_ns), 8.0);
  routes.drop(20 * kSecond_ns);
  EXPECT_DOUBLE_EQ(routes.waited_s(21 * kSecond_ns), 1.0);
}

TEST(RouteKeeper, WithoutAMapThereIsNoRoute) {
  RouteKeeper routes;
  routes.set_map(map_of(room()), 1);
  routes.offer(route_across(3.0));
  routes.take_offer({});
  EXPECT_TRUE(routes.set_map(map_of(room()), 2));
  EXPECT_TRUE(routes.has_route());
  EXPECT_TRUE(routes.set_map(nullptr, 3));
  EXPECT_FALSE(routes.has_route());
  routes.offer(route_across(3.0));
  EXPECT_EQ(routes.take_offer({}), RouteAnswer::kKept);
}

TEST(PathDistance, IsThatOfTheNearestSample) {
  const std::vector<Eigen::Vector2d> points_m = {{0.0, 0.0}, {1.0, 0.0}};
  const std::vector<planning::PathSample> path = straight_path(points_m);
  EXPECT_NEAR(distance_m(path, {0.5, 2.0}), 2.0, 1e-9);
  EXPECT_NEAR(distance_m(path, {4.0, 4.0}), 5.0, 1e-9);
  EXPECT_EQ(distance_m({}, {0.0, 0.0}), HUGE_VAL);
}

}  // namespace
}  // namespace topogeo::navigation
