// Goals and routes as messages.
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/service/conversions.hpp"
#include "topogeo/service/hybrid_map_messages.hpp"
#include "topogeo/service/hybrid_map_mirror.hpp"

namespace topogeo::service {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

TEST(GoalConversion, IsExactForEachKind) {
  Goal goal{7, "operator-1", msg::kGoalPosition, Eigen::Vector2d(0.1, -1e300), 0.3, true};
  const Goal point = from_msg(to_msg(goal, "robot", 6, 8));
  EXPECT_EQ(point.goal_id, 7U);
  EXPECT_EQ(point.client_id, "operator-1");
  EXPECT_EQ(point.kind, msg::kGoalPosition);
  EXPECT_EQ(std::get<Eigen::Vector2d>(point.target), Eigen::Vector2d(0.1, -1e300));
  EXPECT_EQ(point.heading_rad, 0.3);
  EXPECT_TRUE(point.look_around);
  goal.kind = msg::kGoalNode;
  goal.target = planning::NodeNumber{41};
  goal.heading_rad.reset();
  const Goal node = from_msg(to_msg(goal, "robot", 6, 8));
  EXPECT_EQ(std::get<planning::NodeNumber>(node.target).id, 41U);
  EXPECT_FALSE(node.heading_rad);
  goal.kind = msg::kGoalPlace;
  goal.target = std::string("room A");
  EXPECT_EQ(std::get<std::string>(from_msg(to_msg(goal, "robot", 6, 8)).target), "room A");
  for (const msg::GoalKind kind : {msg::kGoalCancel, msg::kGoalPause, msg::kGoalResume}) {
    goal.kind = kind;
    EXPECT_EQ(from_msg(to_msg(goal, "robot", 6, 8)).kind, kind);
  }
  const msg::Goal message = to_msg(goal, "robot", 6, 8);
  EXPECT_EQ(message.robot_id().to_string(), "robot");
  EXPECT_EQ(message.stamp_ns(), 6);
  EXPECT_EQ(message.sequence_number(), 8U);
}

TEST(GoalConversion, RefusesWhatIsNoGoal) {
  Goal goal;
  goal.kind = msg::kGoalPlace;
  EXPECT_THROW(to_msg(goal, "robot", 6, 8), std::invalid_argument) << "the target is a point";
  goal.target = std::string(65, 'a');
  EXPECT_THROW(to_msg(goal, "robot", 6, 8), std::invalid_argument);
  goal.target = std::string();
  EXPECT_THROW(from_msg(to_msg(goal, "robot", 6, 8)), std::invalid_argument);
  goal.target = std::string("a");
  msg::Goal message = to_msg(goal, "robot", 6, 8);
  message.has_heading(true);
  message.heading_rad(kNoNumber);
  EXPECT_THROW(from_msg(message), std::invalid_argument);
  message.has_heading(false);
  EXPECT_NO_THROW(from_msg(message));
  message.kind(static_cast<msg::GoalKind>(6));
  EXPECT_THROW(from_msg(message), std::invalid_argument);
  message.kind(msg::kGoalPosition);
  message.target().y_m(kNoNumber);
  EXPECT_THROW(from_msg(message), std::invalid_argument);
}

planning::HybridRoute found_route() {
  planning::HybridRoute route;
  route.status = planning::RouteStatus::kFound;
  route.points_m = {{0.0, 0.0}, {3.0, 0.0}, {3.0, 4.0}};
  route.clearances_m = {1.0, 0.5, std::numeric_limits<double>::infinity()};
  route.length_m = 7.0;
  route.cost_m = 7.5;
  route.min_clearance_m = 0.4;
  route.zones = {4, 2};
  route.nodes = {1, 99};
  route.parts = {{planning::PlannedOn::kOffBranch, 0, 0},
                 {planning::PlannedOn::kVirtualBranch, 17, 1}};
  return route;
}

TEST(RouteConversion, HasPointsNodesZonesAndMotions) {
  const msg::Route message = to_msg(found_route(), std::numbers::pi / 2, 0.0);
  EXPECT_EQ(message.status(), msg::kRouteFound);
  EXPECT_EQ(message.length_m(), 7.0);
  EXPECT_EQ(message.cost_m(), 7.5);
  EXPECT_EQ(message.min_clearance_m(), 0.4);
  EXPECT_THAT(message.zones(), ElementsAre(4, 2));
  EXPECT_THAT(message.node_ids(), ElementsAre(1, 99));
  ASSERT_THAT(message.points(), SizeIs(3));
  EXPECT_EQ(message.points()[1].clearance_m(), 0.5);
  std::vector<msg::MotionKind> kinds;
  for (const msg::MotionPrimitive& motion : message.primitives()) kinds.push_back(motion.kind());
  EXPECT_THAT(kinds, ElementsAre(msg::kMotionTurnRight, msg::kMotionAdvance, msg::kMotionTurnLeft,
                                 msg::kMotionAdvance, msg::kMotionTurnRight));
}

TEST(RouteConversion, ARefusalHasItsReasonAndTheNearestPlace) {
  planning::HybridRoute none;
  none.status = planning::RouteStatus::kGoalOccupied;
  none.reason = std::string(300, 'x');
  none.nearest_reachable_m = Eigen::Vector2d(1.0, 2.0);
  const msg::Route message = to_msg(none, 0.0, std::nullopt);
  EXPECT_EQ(message.status(), msg::kRouteGoalOccupied);
  EXPECT_THAT(message.message().to_string(), SizeIs(255));
  ASSERT_TRUE(message.has_nearest_reachable());
  EXPECT_EQ(message.nearest_reachable().y_m(), 2.0);
  const navigation::RoutePlan plan = route_plan_from_msg(message, nullptr);
  EXPECT_FALSE(plan.found);
  EXPECT_THAT(plan.reason, SizeIs(255));
  EXPECT_THAT(plan.points_m, IsEmpty());
}

TEST(HybridMapConversion, RulesOfZonesComeAlong) {
  planning::GridFrame frame;
  frame.columns = frame.rows = 40;
  using planning::ZoneKind;
  const std::vector<planning::DrawnZone> drawn{
      {"office", {{0, 0}, {1, 0}, {1, 4}, {0, 4}}, ZoneKind::kRoom, 0.0},
      {"wet", {{1.0, 1.0}, {2, 1}, {2, 2}}, ZoneKind::kNoGo, 0.0},
      {"ramp", {{2, 0}, {3, 0}, {3, 4}, {2, 4}}, ZoneKind::kSlow, 0.25},
      {"aisle", {{3, 0}, {4, 0}, {4, 4}, {3, 4}}, ZoneKind::kOneWay, -1.5},
      {"lane", {{0, 3}, {4, 3}, {4, 4}, {0, 4}}, ZoneKind::kPreferred, 0.0}};
  planning::FreeSpace space(planning::OccupancyGrid(frame, planning::CellState::kFree), {}, drawn);
  planning::ZoneMap parts = planning::zones_by_width(space);
  const planning::HybridMap map(std::move(space), std::move(parts));
  HybridMapMessages messages = to_messages(map, "robot", 5, 6);
  HybridMapMirror mirror;
  for (const msg::GridTile& tile : messages.tiles) {
    messaging::Handle handle;
    handle.bytes[0] = static_cast<std::uint8_t>(tile.tile());
    mirror.put(tile, handle);
  }
  mirror.put(messages.summary);
  ASSERT_TRUE(mirror.map());
  const planning::FreeSpace& got = mirror.map()->space();
  ASSERT_THAT(got.rules().zones(), SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(got.rules().zones()[i].name, drawn[i + 1].name);
    EXPECT_EQ(got.rules().zones()[i].kind, drawn[i + 1].kind);
    EXPECT_EQ(got.rules().zones()[i].value, drawn[i + 1].value);
    EXPECT_EQ(got.rules().zones()[i].polygon_m, drawn[i + 1].polygon_m);
  }
  for (std::size_t i = 0; i < frame.size(); ++i) {
    EXPECT_EQ(got.passable(i), map.space().passable(i));
    EXPECT_EQ(got.rules().directions(i), map.space().rules().directions(i));
    EXPECT_EQ(got.rules().speed_mps(i), map.space().rules().speed_mps(i));
    EXPECT_EQ(got.rules().slowness(i), map.space().rules().slowness(i));
  }
  // Numbers on the wire keep their meaning when a kind of zone is added.
  EXPECT_EQ(messages.summary.rules()[2].kind(), 3);
  EXPECT_EQ(messages.summary.rules()[3].kind(), 7);
  EXPECT_EQ(rule_kind_of(planning::LineKind::kWall), 4);
  messages.summary.rules()[0].kind(0);
  EXPECT_THROW(mirror.put(messages.summary), std::invalid_argument);
  messages.summary.rules()[0].kind(1);
  messages.summary.rules()[0].corners().resize(2);
  EXPECT_THROW(mirror.put(messages.summary), std::invalid_argument);
}

TEST(RouteConversion, GivesTheNavigatorThePlacesOfNodesThatTheMapHas) {
  planning::GridFrame frame;
  frame.columns = frame.rows = 40;
  const planning::FreeSpace space(planning::OccupancyGrid(frame, planning::CellState::kFree));
  const std::vector<planning::DrawnZone> drawn{{"a", {{0, 0}, {1, 0}, {1, 4}, {0, 4}}},
                                               {"b", {{1, 0}, {2, 0}, {2, 4}, {1, 4}}}};
  const planning::HybridMap map(space, planning::drawn_zones(space, drawn));
  ASSERT_THAT(map.nodes(), SizeIs(2));
  msg::Route message = to_msg(found_route(), 0.0, 0.25);
  message.goal_id(5);
  message.map_version(6);
  message.blockages_version(7);
  const navigation::RoutePlan plan = route_plan_from_msg(message, &map);
  EXPECT_EQ(plan.goal_id, 5U);
  EXPECT_EQ(plan.map_version, 6U);
  EXPECT_EQ(plan.blockages_version, 7U);
  EXPECT_TRUE(plan.found);
  EXPECT_EQ(plan.reason, "");
  EXPECT_EQ(plan.heading_rad, 0.25);
  EXPECT_EQ(plan.points_m, found_route().points_m);
  EXPECT_EQ(plan.clearances_m, found_route().clearances_m);
  EXPECT_EQ(plan.parts, found_route().parts);
  EXPECT_THAT(plan.nodes_m, ElementsAre(map.nodes()[1].position_m));
  EXPECT_THAT(route_plan_from_msg(message, nullptr).nodes_m, IsEmpty());
}

TEST(RouteConversion, RefusesAFoundRouteThatLeadsNowhere) {
  msg::Route message = to_msg(found_route(), 0.0, std::nullopt);
  message.points()[1].x_m(kNoNumber);
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument);
  message.points()[1].x_m(3.0);
  EXPECT_NO_THROW(route_plan_from_msg(message, nullptr));
  message.parts()[1].first_point(3);
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument) << "no such point";
  message.parts()[1].first_point(1);
  message.parts()[0].first_point(2);
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument) << "descends";
  message.parts()[0].first_point(0);
  message.parts()[0].on(static_cast<msg::PlannedOn>(4));
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument);
  message.parts().clear();
  message.points()[1].clearance_m(-1.0);
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument);
  message.points().clear();
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument);
  message.status(static_cast<msg::RouteStatus>(11));
  EXPECT_THROW(route_plan_from_msg(message, nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::service
