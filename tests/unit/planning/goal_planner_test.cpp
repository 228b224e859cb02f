// The planner that answers, and the parts of a route, on a floor of two rooms:
//
//   y = 4  #####################
//          #         #         #      door at x = 5, y = 1.5 to 2.5, which a cell of the grid
//   y = 2  # 1-------.-------2 #      shuts when the map is noisy; a branch leads through it
//          #         #         #
//   y = 0  #####################      x = 0 to 10
#include "topogeo/planning/goal_planner.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "branch_maps.hpp"
#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

HybridMap rooms(const std::vector<Cell>& noise = {}) {
  GridFrame frame;
  frame.columns = 100;
  frame.rows = 40;
  OccupancyGrid grid(frame, CellState::kFree);
  fill_box(grid, {0, 0}, {99, 0}, CellState::kOccupied);
  fill_box(grid, {0, 39}, {99, 39}, CellState::kOccupied);
  fill_box(grid, {0, 0}, {0, 39}, CellState::kOccupied);
  fill_box(grid, {99, 0}, {99, 39}, CellState::kOccupied);
  fill_box(grid, {50, 0}, {50, 14}, CellState::kOccupied);
  fill_box(grid, {50, 25}, {50, 39}, CellState::kOccupied);
  for (const Cell& cell : noise) grid.set(cell, CellState::kOccupied);
  FreeSpace space(grid);
  ZoneMap zones = zones_by_width(space);
  return {std::move(space), std::move(zones), {{"window", {8.05, 2.05}}}};
}

topomap::GlobalMap branches() {
  topomap::GlobalMap graph;
  add_map_node(graph, 1, 1.05, 2.05);
  add_map_node(graph, 2, 9.05, 2.05);
  add_map_branch(graph, 7, 1, 2, {{4.0, 2.05}, {5.05, 2.0}, {6.0, 2.05}}, 0.5);
  return graph;
}

const std::vector<Cell> kNoise{{50, 19}, {50, 21}};

std::vector<PlannedOn> grounds(const HybridRoute& route) {
  std::vector<PlannedOn> on;
  for (const RoutePart& part : route.parts) on.push_back(part.on);
  return on;
}

void expect_whole(const HybridRoute& route, const Eigen::Vector2d& from_m,
                  const Eigen::Vector2d& to_m) {
  ASSERT_TRUE(route.found()) << route.reason;
  EXPECT_TRUE(route.points_m.front().isApprox(from_m));
  EXPECT_TRUE(route.points_m.back().isApprox(to_m));
  EXPECT_EQ(route.clearances_m.size(), route.points_m.size());
  EXPECT_NEAR(route.length_m, length_m(route.points_m), 1e-9);
  ASSERT_FALSE(route.parts.empty());
  EXPECT_EQ(route.parts.front().first_point, 0U);
  double parts_m = 0.0;
  for (const PlannedOn on :
       {PlannedOn::kGrid, PlannedOn::kBranch, PlannedOn::kVirtualBranch, PlannedOn::kOffBranch}) {
    parts_m += length_on(route, on);
  }
  EXPECT_NEAR(parts_m, route.length_m, 1e-9);
}

constexpr auto kFirst = PlanFirstOn::kGraph;
const Eigen::Vector2d kWest_m(2.05, 2.35);
const Eigen::Vector2d kEast_m(8.05, 2.05);

TEST(GoalPlanner, AsksTheOneThatTheConfigurationNamesFirst) {
  const HybridMap map = rooms();
  const topomap::GlobalMap graph = branches();
  const HybridRoute grid = plan_to_goal({&map, &graph}, kWest_m, kEast_m);
  expect_whole(grid, kWest_m, kEast_m);
  EXPECT_THAT(grounds(grid), ElementsAre(PlannedOn::kGrid));
  const HybridRoute along = plan_to_goal({&map, &graph}, kWest_m, kEast_m, {}, {{kFirst}, {}, {}});
  expect_whole(along, kWest_m, kEast_m);
  EXPECT_THAT(grounds(along), ElementsAre(PlannedOn::kOffBranch, PlannedOn::kBranch));
  EXPECT_EQ(along.parts[1].branch_id, 7U);
  EXPECT_NEAR(length_on(along, PlannedOn::kOffBranch), 0.3, 1e-9);
}

TEST(GoalPlanner, FollowsBranchesWhereTheGridHasNoWay) {
  const HybridMap map = rooms(kNoise);
  const topomap::GlobalMap graph = branches();
  EXPECT_FALSE(plan_to_goal({&map, nullptr}, kWest_m, kEast_m).found());
  const HybridRoute route = plan_to_goal({&map, &graph}, kWest_m, Target("window"));
  expect_whole(route, kWest_m, kEast_m);
  EXPECT_THAT(grounds(route), testing::Contains(PlannedOn::kBranch));
  EXPECT_NEAR(route.min_clearance_m, 0.5, 1e-9);
}

TEST(GoalPlanner, PlansOnTheGridWhereBranchesHaveNoWay) {
  const HybridMap map = rooms();
  topomap::GlobalMap graph = branches();
  for (topomap::BranchPoint& p : graph.branches[0].points) p.clearance_m = 0.1;
  const HybridRoute route = plan_to_goal({&map, &graph}, kWest_m, kEast_m, {}, {{kFirst}, {}, {}});
  EXPECT_THAT(grounds(route), Each(PlannedOn::kGrid));
}

TEST(GoalPlanner, NeedsNoGrid) {
  const topomap::GlobalMap graph = branches();
  const HybridRoute route = plan_to_goal({nullptr, &graph}, kWest_m, kEast_m);
  expect_whole(route, kWest_m, kEast_m);
  const std::vector<Eigen::Vector2d> filled_m{{5.05, 2.05}};
  const HybridRoute shut = plan_to_goal({nullptr, &graph}, kWest_m, kEast_m, filled_m);
  EXPECT_EQ(shut.status, RouteStatus::kUnreachable);
  EXPECT_EQ(plan_to_goal({nullptr, &graph}, kWest_m, Target("window")).status,
            RouteStatus::kUnknownPlace);
  EXPECT_EQ(plan_to_goal({nullptr, &graph}, kWest_m, NodeNumber{0}).status,
            RouteStatus::kUnknownNode);
  EXPECT_EQ(plan_to_goal({nullptr, &graph}, kWest_m, Eigen::Vector2d(8.0, 3.9)).status,
            RouteStatus::kGoalOccupied)
      << "beyond the clearance of the branch nothing is proved";
  EXPECT_EQ(plan_to_goal({nullptr, &graph}, kWest_m, Eigen::Vector2d(8.0, 30.0)).status,
            RouteStatus::kGoalOutside);
  EXPECT_EQ(plan_to_goal({}, kWest_m, kEast_m).status, RouteStatus::kUnreachable);
}

TEST(GoalPlanner, ReportsTheReasonOfTheGridWhenNeitherHasAWay) {
  const HybridMap map = rooms();
  const topomap::GlobalMap graph = branches();
  const HybridRoute in_wall = plan_to_goal({&map, &graph}, kWest_m, Eigen::Vector2d(5.05, 1.0));
  EXPECT_EQ(in_wall.status, RouteStatus::kGoalOccupied);
  EXPECT_THAT(in_wall.reason, HasSubstr("in an obstacle"));
  EXPECT_TRUE(in_wall.nearest_reachable_m);
  const HybridRoute near_wall = plan_to_goal({&map, &graph}, kWest_m, Eigen::Vector2d(4.85, 1.0));
  EXPECT_THAT(near_wall.reason, HasSubstr("too near"));
  std::vector<Eigen::Vector2d> door_m(10);
  for (int k = 0; k < 10; ++k) door_m[static_cast<std::size_t>(k)] = {5.05, 1.55 + 0.1 * k};
  const HybridRoute shut = plan_to_goal({&map, &graph}, kWest_m, kEast_m, door_m);
  EXPECT_EQ(shut.status, RouteStatus::kUnreachable);
  EXPECT_THAT(shut.reason, HasSubstr("closed now"));
}

TEST(GoalPlanner, FindsARouteWhereverEitherDoes) {
  const topomap::GlobalMap graph = branches();
  support::Random random(3);
  int only_grid = 0;
  int only_graph = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<Cell> noise;
    for (std::uint64_t k = random.below(4); k > 0; --k) {
      noise.push_back({50, 15 + static_cast<std::int32_t>(random.below(10))});
    }
    const HybridMap map = rooms(noise);
    const Eigen::Vector2d from_m = random_free_point_m(map.space(), random);
    const Eigen::Vector2d to_m = random_free_point_m(map.space(), random);
    const bool grid = plan_to_goal({&map, nullptr}, from_m, to_m).found();
    const bool along = plan_to_goal({nullptr, &graph}, from_m, to_m).found();
    const bool live = plan_to_goal({&map, &graph}, from_m, to_m).found();
    EXPECT_TRUE(live || (!grid && !along)) << round;
    EXPECT_EQ(plan_to_goal({&map, &graph}, from_m, to_m, {}, {{kFirst}, {}, {}}).found(), live);
    only_grid += grid && !along ? 1 : 0;
    only_graph += along && !grid ? 1 : 0;
  }
  EXPECT_GT(only_grid, 5);
  EXPECT_GT(only_graph, 0);
}

TEST(GoalPlanner, LeavesOutPointsThatAreNearlyInLine) {
  topomap::GlobalMap graph;
  add_map_node(graph, 1, 0, 0);
  add_map_node(graph, 2, 10, 0);
  std::vector<Eigen::Vector2d> between_m;
  for (int k = 1; k < 200; ++k) between_m.emplace_back(0.05 * k, 0.02 * (k % 2));
  add_map_branch(graph, 7, 1, 2, between_m);
  const HybridRoute route = plan_to_goal({nullptr, &graph}, {0.0, 0.0}, Eigen::Vector2d(10.0, 0.0));
  EXPECT_THAT(route.points_m, testing::SizeIs(2));
}

}  // namespace
}  // namespace topogeo::planning
