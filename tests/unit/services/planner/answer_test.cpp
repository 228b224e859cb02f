// The planner's answers on a floor of two rooms with a door between them, 10 x 4 m:
//
//   y = 4  #####################
//          #   room A  #room B #
//   y = 2  #           .       #      door from y = 1.5 to 2.5, at x = 6
//          #           #       #
//   y = 0  #####################      x = 0 to 10
#include "planner/answer.hpp"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::planner {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

planning::OccupancyGrid two_rooms() {
  planning::GridFrame frame;
  frame.columns = 100;
  frame.rows = 40;
  planning::OccupancyGrid grid(frame, planning::CellState::kFree);
  for (std::int32_t column = 0; column < frame.columns; ++column) {
    grid.set({column, 0}, planning::CellState::kOccupied);
    grid.set({column, 39}, planning::CellState::kOccupied);
  }
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    grid.set({0, row}, planning::CellState::kOccupied);
    grid.set({99, row}, planning::CellState::kOccupied);
    if (row < 15 || row >= 25) grid.set({60, row}, planning::CellState::kOccupied);
  }
  return grid;
}

planning::HybridMap floor_map() {
  const planning::FreeSpace space(two_rooms());
  const std::vector<planning::DrawnZone> rooms{
      {"room A", {{0, 0}, {6.05, 0}, {6.05, 4}, {0, 4}}},
      {"room B", {{6.05, 0}, {10, 0}, {10, 4}, {6.05, 4}}}};
  return {space,
          planning::drawn_zones(space, rooms),
          {{"Desk", {1.55, 2.05}}, {"window", {9.05, 2.05}}, {"wall", {6.05, 0.5}}}};
}

// Points that fill the door.
std::vector<Eigen::Vector2d> shut_door_m() {
  std::vector<Eigen::Vector2d> points_m(10);
  for (std::size_t k = 0; k < points_m.size(); ++k) {
    points_m[k] = {6.05, 1.55 + 0.1 * static_cast<double>(k)};
  }
  return points_m;
}

std::optional<service::LivePose> pose_at(double x_m, double y_m, double theta_rad = 0.0) {
  service::LivePose pose;
  pose.status.state = localization::LocalizationState::kTracking;
  pose.T_map_robot = {x_m, y_m, theta_rad};
  return pose;
}

msg::Goal goal_at(double x_m, double y_m) {
  msg::Goal goal;
  goal.kind(msg::kGoalPosition);
  goal.target().x_m(x_m);
  goal.target().y_m(y_m);
  return goal;
}

msg::Goal goal_node(std::uint32_t id) {
  msg::Goal goal;
  goal.kind(msg::kGoalNode);
  goal.node_id(id);
  return goal;
}

msg::Goal goal_place(const std::string& name) {
  msg::Goal goal;
  goal.kind(msg::kGoalPlace);
  goal.place(name);
  return goal;
}

TEST(Answer, RouteThroughTheDoorWithItsMotions) {
  const planning::HybridMap map = floor_map();
  msg::Goal goal = goal_at(9.05, 2.05);
  goal.has_heading(true);
  goal.heading_rad(-std::numbers::pi / 2);
  const msg::Route route =
      answer(goal, {&map, nullptr}, pose_at(1.55, 2.05, std::numbers::pi / 2), {});
  ASSERT_EQ(route.status(), msg::kRouteFound) << route.message().to_string();
  EXPECT_EQ(route.message().to_string(), "");
  EXPECT_NEAR(route.length_m(), 7.5, 1e-9);
  EXPECT_NEAR(route.cost_m(), 7.5, 1e-9);
  EXPECT_NEAR(route.min_clearance_m(), 0.6, 0.11);
  EXPECT_THAT(route.zones(), SizeIs(2));
  EXPECT_THAT(route.node_ids(), testing::ElementsAre(0));
  EXPECT_TRUE(route.has_heading());
  EXPECT_EQ(route.heading_rad(), -std::numbers::pi / 2);
  ASSERT_THAT(route.points(), SizeIs(2));
  EXPECT_EQ(route.points()[0].x_m(), 1.55);
  EXPECT_EQ(route.points()[1].x_m(), 9.05);
  EXPECT_NEAR(route.points()[0].clearance_m(), 1.5, 1e-9);
  ASSERT_THAT(route.primitives(), SizeIs(3));
  EXPECT_EQ(route.primitives()[0].kind(), msg::kMotionTurnRight);
  EXPECT_NEAR(route.primitives()[0].amount(), std::numbers::pi / 2, 1e-9);
  EXPECT_EQ(route.primitives()[1].kind(), msg::kMotionAdvance);
  EXPECT_NEAR(route.primitives()[1].amount(), 7.5, 1e-9);
  EXPECT_EQ(route.primitives()[2].kind(), msg::kMotionTurnRight);
}

TEST(Answer, PlacesAreFoundByTheirNamesCapitalsOrNot) {
  const planning::HybridMap map = floor_map();
  for (const char* name : {"Desk", "desk", "DESK"}) {
    const msg::Route route = answer(goal_place(name), {&map, nullptr}, pose_at(3.05, 2.05), {});
    ASSERT_EQ(route.status(), msg::kRouteFound) << name;
    EXPECT_EQ(route.points().back().x_m(), 1.55);
  }
  const msg::Route route = answer(goal_node(0), {&map, nullptr}, pose_at(3.05, 2.05), {});
  EXPECT_EQ(route.status(), msg::kRouteFound);
}

TEST(Answer, NoRouteHasItsReason) {
  const planning::HybridMap map = floor_map();
  const auto pose = pose_at(1.55, 2.05);
  const auto status = [&](const msg::Goal& goal, const char* reason) {
    const msg::Route route = answer(goal, {&map, nullptr}, pose, {});
    EXPECT_THAT(route.message().to_string(), HasSubstr(reason));
    EXPECT_TRUE(route.points().empty());
    EXPECT_TRUE(route.primitives().empty());
    return route.status();
  };
  EXPECT_EQ(status(goal_place("dask"), "'Desk', 'wall', 'window'"), msg::kRouteUnknownPlace);
  EXPECT_EQ(status(goal_place(""), "place: expected a name"), msg::kRouteInvalidPoint);
  EXPECT_EQ(status(goal_node(7), "number 7, the map has 1 nodes"), msg::kRouteUnknownNode);
  EXPECT_EQ(status(goal_place("wall"), "in an obstacle"), msg::kRouteGoalOccupied);
  EXPECT_EQ(status(goal_at(5.75, 0.65), "from an obstacle: too near"), msg::kRouteGoalOccupied);
  EXPECT_EQ(status(goal_at(-3.0, 1.0), "outside of the grid"), msg::kRouteGoalOutside);
  EXPECT_EQ(status(goal_at(std::numeric_limits<double>::quiet_NaN(), 1.0), "target.x_m"),
            msg::kRouteInvalidPoint);
  msg::Goal nowhere = goal_at(2.0, 2.0);
  nowhere.has_heading(true);
  nowhere.heading_rad(std::numeric_limits<double>::infinity());
  EXPECT_EQ(status(nowhere, "heading_rad"), msg::kRouteInvalidPoint);
  msg::Route refusal;
  EXPECT_FALSE(goal_from(nowhere, refusal));
  EXPECT_EQ(refusal.status(), msg::kRouteInvalidPoint);
  EXPECT_TRUE(goal_from(goal_at(2.0, 2.0), refusal));
}

TEST(Answer, ARefusedGoalHasThePlaceNextToIt) {
  const planning::HybridMap map = floor_map();
  const msg::Route route = answer(goal_at(6.05, 0.55), {&map, nullptr}, pose_at(1.55, 2.05), {});
  ASSERT_TRUE(route.has_nearest_reachable());
  EXPECT_NEAR(route.nearest_reachable().x_m(), 6.05, 0.46);
  const msg::Goal there = goal_at(route.nearest_reachable().x_m(), route.nearest_reachable().y_m());
  EXPECT_EQ(answer(there, {&map, nullptr}, pose_at(1.55, 2.05), {}).status(), msg::kRouteFound);
}

// A branch through the middle of both rooms and the door between them.
topomap::GlobalMap branch_map() {
  topomap::GlobalMap graph;
  graph.nodes.push_back({1, topomap::NodeKind::kReal, {1.0, 2.05}, 0.5, 1});
  graph.nodes.push_back({2, topomap::NodeKind::kReal, {9.05, 2.05}, 0.5, 1});
  topomap::MapBranch branch;
  branch.id = 4;
  branch.node_a = 1;
  branch.node_b = 2;
  branch.points = {{{1.0, 2.05}, 0.5}, {{9.05, 2.05}, 0.5}};
  graph.branches.push_back(branch);
  return graph;
}

TEST(Answer, WithoutAGridTheRouteFollowsBranchesAndSaysSo) {
  const topomap::GlobalMap graph = branch_map();
  const msg::Route route = answer(goal_at(9.05, 2.05), {nullptr, &graph}, pose_at(1.55, 2.25), {});
  ASSERT_EQ(route.status(), msg::kRouteFound) << route.message().to_string();
  ASSERT_THAT(route.parts(), SizeIs(2));
  EXPECT_EQ(route.parts()[0].on(), msg::kPlannedOffBranch);
  EXPECT_EQ(route.parts()[1].on(), msg::kPlannedOnBranch);
  EXPECT_EQ(route.parts()[1].branch_id(), 4U);
  EXPECT_EQ(route.points().back().x_m(), 9.05);
  EXPECT_FALSE(route.primitives().empty());
  EXPECT_EQ(answer(goal_place("Desk"), {nullptr, &graph}, pose_at(1.55, 2.25), {}).status(),
            msg::kRouteUnknownPlace);
  const topomap::GlobalMap nothing;
  EXPECT_EQ(answer(goal_at(9.05, 2.05), {nullptr, &nothing}, pose_at(1.55, 2.25), {}).status(),
            msg::kRouteNoMap);
}

TEST(Answer, TheGridIsAskedFirstUnlessTheConfigurationNamesTheGraph) {
  const planning::HybridMap map = floor_map();
  const topomap::GlobalMap graph = branch_map();
  planning::GoalPlannerConfig config;
  const auto first_part = [&] {
    const msg::Route route =
        answer(goal_at(9.05, 2.05), {&map, &graph}, pose_at(1.55, 2.05), {}, config);
    return route.parts().at(0).on();
  };
  EXPECT_EQ(first_part(), msg::kPlannedOnGrid);
  config.planner.on = planning::PlanFirstOn::kGraph;
  EXPECT_EQ(first_part(), msg::kPlannedOnBranch);
}

TEST(Answer, WithoutMapOrPoseThereIsNone) {
  const planning::HybridMap map = floor_map();
  const msg::Goal goal = goal_at(3.05, 2.05);
  EXPECT_EQ(answer(goal, {}, pose_at(1.55, 2.05), {}).status(), msg::kRouteNoMap);
  EXPECT_EQ(answer(goal, {&map, nullptr}, std::nullopt, {}).status(), msg::kRouteNoPose);
  auto lost = pose_at(1.55, 2.05);
  lost->status.state = localization::LocalizationState::kLost;
  const msg::Route route = answer(goal, {&map, nullptr}, lost, {});
  EXPECT_EQ(route.status(), msg::kRouteNoPose);
  EXPECT_THAT(route.message().to_string(), HasSubstr("LOST"));
  lost->status.state = localization::LocalizationState::kAmbiguous;
  EXPECT_EQ(answer(goal, {&map, nullptr}, lost, {}).status(), msg::kRouteFound);
}

TEST(Answer, AMapWithoutZonesIsNone) {
  planning::GridFrame frame;
  frame.columns = frame.rows = 5;
  const planning::FreeSpace space{planning::OccupancyGrid(frame)};
  const planning::HybridMap map(space, planning::zones_by_width(space));
  const msg::Route route = answer(goal_at(0.25, 0.25), {&map, nullptr}, pose_at(0.15, 0.15), {});
  EXPECT_EQ(route.status(), msg::kRouteNoMap);
  EXPECT_THAT(route.message().to_string(), HasSubstr("no zone"));
}

TEST(Answer, ARobotBesideTheMapOrInAWallCannotBegin) {
  const planning::HybridMap map = floor_map();
  const msg::Goal goal = goal_at(3.05, 2.05);
  EXPECT_EQ(answer(goal, {&map, nullptr}, pose_at(-2.0, 2.0), {}).status(),
            msg::kRouteStartOutside);
  EXPECT_EQ(answer(goal, {&map, nullptr}, pose_at(6.05, 0.5), {}).status(),
            msg::kRouteStartOccupied);
  EXPECT_EQ(answer(goal, {&map, nullptr}, pose_at(0.25, 2.05), {}).status(), msg::kRouteFound)
      << "too near to a wall, but off it";
}

TEST(Answer, ADoorThatIsShutNowCutsTheOtherRoomOff) {
  const planning::HybridMap map = floor_map();
  const msg::Goal goal = goal_place("window");
  const msg::Route open = answer(goal, {&map, nullptr}, pose_at(1.55, 2.05), {});
  EXPECT_EQ(open.status(), msg::kRouteFound);
  std::vector<Eigen::Vector2d> blocked_m = shut_door_m();
  blocked_m.emplace_back(-500.0, 3.0);  // beyond the map
  const msg::Route shut = answer(goal, {&map, nullptr}, pose_at(1.55, 2.05), blocked_m);
  EXPECT_EQ(shut.status(), msg::kRouteUnreachable);
  EXPECT_THAT(shut.message().to_string(), HasSubstr("closed now"));
  ASSERT_TRUE(shut.has_nearest_reachable());
  EXPECT_LT(shut.nearest_reachable().x_m(), 6.0);
  EXPECT_GT(shut.nearest_reachable().x_m(), 5.5);
  // In front of the door, the robot can still drive away.
  EXPECT_EQ(answer(goal_place("Desk"), {&map, nullptr}, pose_at(5.85, 2.05), blocked_m).status(),
            msg::kRouteFound);
}

}  // namespace
}  // namespace topogeo::planner
