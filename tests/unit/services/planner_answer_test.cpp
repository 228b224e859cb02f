//   node 1 --- 10 m --- node 2        node 3 (no branch)
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/planner_service.hpp"

namespace topogeo::planner {
namespace {

using testing::HasSubstr;

topomap::GlobalMap one_branch() {
  topomap::GlobalMap map;
  map.nodes = {{1, topomap::NodeKind::kReal, {0, 0}, 1.0, 1},
               {2, topomap::NodeKind::kReal, {10, 0}, 1.0, 1},
               {3, topomap::NodeKind::kReal, {50, 0}, 1.0, 1}};
  map.branches = {{1, 1, 2, false, 1, {{{0, 0}, 1.0}, {{10, 0}, 1.0}}}};
  return map;
}

service::LivePose pose_at(double x_m) {
  service::LivePose pose;
  pose.belief.state = localization::LocalizationState::kTracking;
  pose.T_map_robot = {x_m, 0.5, 0.0};
  return pose;
}

msg::Goal goal_at(double x_m) {
  msg::Goal goal;
  goal.kind(msg::kGoalPosition);
  goal.target().x_m(x_m);
  return goal;
}

msg::Goal goal_node(std::uint32_t id) {
  msg::Goal goal;
  goal.kind(msg::kGoalNode);
  goal.node_id(id);
  return goal;
}

TEST(Answer, RouteFromThePoseToTheGoal) {
  const msg::Route route = answer(goal_at(8.0), one_branch(), pose_at(1.0), {});
  EXPECT_EQ(route.status(), msg::kRouteFound);
  EXPECT_DOUBLE_EQ(route.length_m(), 7.0);
  EXPECT_EQ(route.message().to_string(), "");
  EXPECT_EQ(route.points().front().x_m(), 1.0);
  EXPECT_EQ(route.points().back().x_m(), 8.0);
}

TEST(Answer, RouteToANode) {
  const msg::Route route = answer(goal_node(2), one_branch(), pose_at(1.0), {});
  EXPECT_EQ(route.status(), msg::kRouteFound);
  EXPECT_DOUBLE_EQ(route.length_m(), 9.0);
}

TEST(Answer, NoRouteHasItsReason) {
  const auto map = one_branch();
  EXPECT_EQ(answer(goal_at(8), std::nullopt, pose_at(1), {}).status(), msg::kRouteNoMap);
  EXPECT_EQ(answer(goal_at(8), topomap::GlobalMap{}, pose_at(1), {}).status(), msg::kRouteNoMap);
  EXPECT_EQ(answer(goal_at(8), map, std::nullopt, {}).status(), msg::kRouteNoPose);
  EXPECT_EQ(answer(goal_at(8), map, service::LivePose{}, {}).status(), msg::kRouteNoPose);
  const msg::Route unknown = answer(goal_node(9), map, pose_at(1), {});
  EXPECT_EQ(unknown.status(), msg::kRouteUnreachable);
  EXPECT_THAT(unknown.message().to_string(), HasSubstr("no node 9"));
  for (const msg::Goal& goal :
       {goal_node(3), goal_at(50), goal_at(std::numeric_limits<double>::quiet_NaN())}) {
    const msg::Route route = answer(goal, map, pose_at(1), {});
    EXPECT_EQ(route.status(), msg::kRouteUnreachable);
    EXPECT_NE(route.message().to_string(), "");
    EXPECT_TRUE(route.points().empty());
  }
}

}  // namespace
}  // namespace topogeo::planner
