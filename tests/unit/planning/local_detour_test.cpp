#include "topogeo/planning/local_detour.hpp"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/motion_primitives.hpp"

#include "floors.hpp"

namespace topogeo::planning {
namespace {

// A corridor of 10 x 3 m.
FreeSpace corridor() {
  std::vector<std::string> lines(30, std::string(100, '.'));
  lines.front().assign(100, '#');
  lines.back().assign(100, '#');
  return FreeSpace(grid_of_text(lines, 0.1));
}

const Eigen::Vector2d kStart_m(0.55, 1.55);
const Eigen::Vector2d kGoal_m(9.55, 1.55);

std::vector<Eigen::Vector2d> wall_m(double x_m, double y0_m, double y1_m) {
  std::vector<Eigen::Vector2d> points_m;
  for (double y_m = y0_m; y_m <= y1_m; y_m += 0.05) points_m.emplace_back(x_m, y_m);
  return points_m;
}

TEST(LocalDetour, LeavesAClearRouteAsItIs) {
  const FreeSpace space = corridor();
  const HybridRoute route = plan_on_grid(space, kStart_m, kGoal_m);
  const Detour detour = plan_detour(space, route.cells, kStart_m, kGoal_m, wall_m(2.0, 0.1, 0.6));
  EXPECT_EQ(detour.status, DetourStatus::kClear);
  EXPECT_EQ(detour.cells, route.cells);
}

TEST(LocalDetour, GoesRoundAnObstacleAndBackToTheRoute) {
  const FreeSpace space = corridor();
  const HybridRoute route = plan_on_grid(space, kStart_m, kGoal_m);
  const auto obstacle_m = wall_m(2.0, 1.2, 1.8);
  const Detour detour = plan_detour(space, route.cells, kStart_m, kGoal_m, obstacle_m);
  ASSERT_EQ(detour.status, DetourStatus::kFound) << detour.reason;
  EXPECT_EQ(detour.cells.front(), route.cells.front());
  EXPECT_EQ(detour.cells.back(), route.cells.back());
  EXPECT_GT(detour.rejoins, 15U);
  for (const Cell& cell : detour.cells) {
    ASSERT_TRUE(space.passable(cell));
    for (const Eigen::Vector2d& point_m : obstacle_m) {
      ASSERT_GT((space.frame().center_m(cell) - point_m).norm(), 0.25);
    }
  }
  // The straightened path keeps its distance, too.
  for (std::size_t i = 1; i < detour.points_m.size(); ++i) {
    const Eigen::Vector2d step_m = detour.points_m[i] - detour.points_m[i - 1];
    for (int k = 0; k <= 200; ++k) {
      const Eigen::Vector2d at_m = detour.points_m[i - 1] + k / 200.0 * step_m;
      for (const Eigen::Vector2d& point_m : obstacle_m) {
        ASSERT_GT((at_m - point_m).norm(), 0.2);
      }
    }
  }
  EXPECT_EQ(detour.points_m.back(), kGoal_m);
}

TEST(LocalDetour, TakesTheShorterSide) {
  const FreeSpace space = corridor();
  const HybridRoute route = plan_on_grid(space, kStart_m, kGoal_m);
  const Detour detour = plan_detour(space, route.cells, kStart_m, kGoal_m, wall_m(2.0, 0.1, 1.6));
  ASSERT_EQ(detour.status, DetourStatus::kFound);
  EXPECT_TRUE(std::any_of(detour.cells.begin(), detour.cells.end(),
                          [](const Cell& cell) { return cell.row > 18; }));
}

TEST(LocalDetour, SaysWhenTheWholeWidthIsBlocked) {
  const FreeSpace space = corridor();
  const HybridRoute route = plan_on_grid(space, kStart_m, kGoal_m);
  EXPECT_EQ(plan_detour(space, route.cells, kStart_m, kGoal_m, wall_m(2.0, 0.1, 2.9)).status,
            DetourStatus::kBlocked);
  // The goal itself is blocked.
  const std::vector<Eigen::Vector2d> on_goal_m{kGoal_m};
  EXPECT_EQ(plan_detour(space, route.cells, {8.0, 1.5}, kGoal_m, on_goal_m).status,
            DetourStatus::kBlocked);
}

TEST(LocalDetour, KnowsWhenTheRobotIsLost) {
  const FreeSpace space = corridor();
  const HybridRoute route = plan_on_grid(space, kStart_m, kGoal_m);
  EXPECT_EQ(plan_detour(space, route.cells, {-5.0, 1.5}, kGoal_m, {}).status, DetourStatus::kLost);
  const std::vector<Eigen::Vector2d> all_round_m = wall_m(1.0, 0.1, 2.9);
  EXPECT_EQ(plan_detour(space, route.cells, {1.0, 0.05}, kGoal_m, all_round_m).status,
            DetourStatus::kLost);
}

// A thin wall between two corridors, with the robot so close to it that it must snap: the open
// space of its own corridor is farther away than that of the other one.
TEST(LocalDetour, StartsOnTheRobotsSideOfAWall) {
  std::vector<std::string> lines(41, std::string(60, '.'));
  lines[20].assign(60, '#');
  InflationConfig inflation;
  inflation.forbidden_cells = 1.0;
  const FreeSpace space(grid_of_text(lines, 0.1), inflation);
  const std::vector<Cell> route{{30, 10}, {31, 10}, {32, 10}, {33, 10}, {34, 10}, {35, 10}};
  const Eigen::Vector2d robot_m(3.05, 1.95);  // just below the wall, in row 19
  // Obstacles below the robot leave no open cell near it.
  std::vector<Eigen::Vector2d> seen_m(60);
  for (std::size_t i = 0; i < seen_m.size(); ++i) {
    seen_m[i] = {0.1 * static_cast<double>(i) + 0.05, 1.75};
  }
  const Detour none = plan_detour(space, route, robot_m, {3.55, 1.05}, seen_m);
  EXPECT_EQ(none.status, DetourStatus::kLost) << none.cells.front().row;
  const Detour free = plan_detour(space, route, robot_m, {3.55, 1.05}, {});
  ASSERT_EQ(free.status, DetourStatus::kClear) << free.reason;
  EXPECT_EQ(free.cells.front(), (Cell{30, 18}));
}

// The robot is in a gap between two obstacles, closer to the side that it came from.
TEST(LocalDetour, LeavesATightPlaceToTheSideOfTheRoute) {
  const FreeSpace space = corridor();
  const HybridRoute route = plan_on_grid(space, kStart_m, kGoal_m);
  std::vector<Eigen::Vector2d> gap_m = wall_m(5.0, 0.1, 1.25);
  const std::vector<Eigen::Vector2d> upper_m = wall_m(5.0, 1.85, 2.9);
  gap_m.insert(gap_m.end(), upper_m.begin(), upper_m.end());
  DetourConfig config;
  config.half_side_m = 2.0;
  const Eigen::Vector2d robot_m(5.02, 1.55);
  const Detour detour = plan_detour(space, route.cells, robot_m, kGoal_m, gap_m, config);
  ASSERT_EQ(detour.status, DetourStatus::kFound) << detour.reason;
  EXPECT_GT(space.frame().center_m(detour.cells.front()).x(), 5.0);
  EXPECT_EQ(detour.cells.back(), route.cells.back());
}

TEST(LocalDetour, RefusesBadInput) {
  const FreeSpace space = corridor();
  EXPECT_THROW(plan_detour(space, {}, kStart_m, kGoal_m, {}), std::invalid_argument);
  DetourConfig config;
  config.half_side_m = 0.0;
  EXPECT_THROW(check(config), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::planning
