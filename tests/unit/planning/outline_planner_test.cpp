#include "topogeo/planning/outline_planner.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "floors.hpp"

namespace topogeo::planning {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

OutlineConfig rectangle() {
  OutlineConfig config;
  config.footprint = {{{0.6, 0.3}, {0.6, -0.3}, {-0.6, -0.3}, {-0.6, 0.3}}};
  return config;
}

// Two rooms of 4 x 4 m and a door of 0.9 m between them; or a passage of `depth` cells.
OccupancyGrid two_rooms(int depth = 1) {
  OccupancyGrid grid = grid_of_text(std::vector<std::string>(42, std::string(84, '.')), 0.1);
  fill_box(grid, {0, 0}, {83, 0}, CellState::kOccupied);
  fill_box(grid, {0, 41}, {83, 41}, CellState::kOccupied);
  fill_box(grid, {0, 0}, {0, 41}, CellState::kOccupied);
  fill_box(grid, {83, 0}, {83, 41}, CellState::kOccupied);
  fill_box(grid, {42, 0}, {41 + depth, 15}, CellState::kOccupied);
  fill_box(grid, {42, 25}, {41 + depth, 41}, CellState::kOccupied);
  return grid;
}

geometry::Pose2 robot_at(const PathSample& sample) {
  geometry::Pose2 pose = sample.T_map_robot;
  if (sample.backward) pose.theta_rad = geometry::wrap_angle(pose.theta_rad + std::numbers::pi);
  return pose;
}

/// Least distance of the outline from the centre of an occupied cell along a path, turns included.
double least_clearance_m(const OccupancyGrid& grid, const OutlinePath& path,
                         const geometry::Footprint& footprint) {
  std::vector<Eigen::Vector2d> occupied_m;
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    if (grid.cells()[i] != CellState::kOccupied) continue;
    occupied_m.push_back(grid.frame().center_m(grid.frame().cell_at(i)));
  }
  double least_m = 10.0;
  for (const PathSample& sample : path.samples) {
    for (int k = 0; k <= 20; ++k) {
      geometry::Pose2 pose = robot_at(sample);
      pose.theta_rad -= sample.turn_on_spot_rad * k / 20.0;
      const geometry::Pose2 T_body_map = geometry::inverse(pose);
      for (const Eigen::Vector2d& cell_m : occupied_m) {
        if ((cell_m - pose.position_m()).norm() > 1.0) continue;
        least_m = std::min(least_m, geometry::signed_distance_m(footprint, T_body_map * cell_m));
      }
      if (sample.turn_on_spot_rad == 0.0) break;
    }
  }
  return least_m;
}

TEST(OutlinePlanner, EntersANarrowDoorStraight) {
  const FreeSpace space(two_rooms());
  const OutlineConfig config = rectangle();
  const geometry::Pose2 start{1.0, 1.0, kQuarter};
  const OutlinePath path = plan_outline(space, start, {{7.4, 3.2}, -kQuarter}, {}, config);
  ASSERT_TRUE(path.found()) << path.reason;
  // Interpolated distances exceed exact ones by a few millimetres.
  EXPECT_GT(least_clearance_m(space.grid(), path, config.footprint), config.margin_m - 0.03);
  EXPECT_NEAR((path.samples.back().T_map_robot.position_m() - Eigen::Vector2d(7.4, 3.2)).norm(),
              0.0, 0.01);
  for (const PathSample& sample : path.samples) {
    if (std::fabs(sample.T_map_robot.x_m - 4.25) > 0.6) continue;
    EXPECT_LT(std::fabs(std::sin(sample.T_map_robot.theta_rad)), 0.5);  // aslant, it would touch
    EXPECT_EQ(sample.turn_on_spot_rad, 0.0);
  }
}

TEST(OutlinePlanner, ReversesOutOfADeadEnd) {
  // A passage that is too narrow to turn in, closed at its end.
  OccupancyGrid grid = two_rooms(30);
  fill_box(grid, {72, 15}, {72, 25}, CellState::kOccupied);
  const FreeSpace space(std::move(grid));
  const OutlineConfig config = rectangle();
  const OutlinePath path =
      plan_outline(space, {6.0, 2.05, 0.0}, {{1.5, 1.0}, kQuarter}, {}, config);
  ASSERT_TRUE(path.found()) << path.reason;
  EXPECT_TRUE(path.samples.front().backward);
  EXPECT_GT(least_clearance_m(space.grid(), path, config.footprint), config.margin_m - 0.03);
  for (const PathSample& sample : path.samples) {
    if (sample.T_map_robot.x_m < 4.8) continue;
    EXPECT_EQ(sample.turn_on_spot_rad, 0.0);
  }
}

TEST(OutlinePlanner, AvoidsSeenObstacles) {
  const FreeSpace space(two_rooms());
  const OutlineConfig config = rectangle();
  std::vector<Eigen::Vector2d> obstacles_m;
  for (double y_m = 1.0; y_m <= 2.4; y_m += 0.05) obstacles_m.emplace_back(2.5, y_m);
  const OutlinePath path =
      plan_outline(space, {1.2, 2.0, 0.0}, {{7.0, 2.0}, std::nullopt}, obstacles_m, config);
  ASSERT_TRUE(path.found()) << path.reason;
  OccupancyGrid seen = space.grid();
  for (const auto& obstacle_m : obstacles_m) {
    seen.set(*seen.frame().cell_of(obstacle_m), CellState::kOccupied);
  }
  EXPECT_GT(least_clearance_m(seen, path, config.footprint), config.margin_m - 0.03);
}

TEST(OutlinePlanner, RefusesWithAReason) {
  const FreeSpace space(two_rooms());
  OutlineConfig config = rectangle();
  const OutlinePath across =
      plan_outline(space, {1.0, 1.0, 0.0}, {{4.25, 2.05}, kQuarter}, {}, config);
  EXPECT_EQ(across.status, OutlineStatus::kGoalBlocked);
  EXPECT_NE(across.reason.find("does not fit"), std::string::npos);
  // Wider than the door.
  config.footprint = {{{0.55, 0.55}, {0.55, -0.55}, {-0.55, -0.55}, {-0.55, 0.55}}};
  const OutlinePath wide = plan_outline(space, {1.0, 1.0, 0.0}, {{7.0, 2.0}, {}}, {}, config);
  EXPECT_EQ(wide.status, OutlineStatus::kUnreachable);
  EXPECT_NE(wide.reason.find("wide enough"), std::string::npos);
}

OutlineConfig car() {
  OutlineConfig config = rectangle();
  config.minimum_radius_m = 0.8;
  return config;
}

/// No sample turns on the spot or more tightly than the radius, each follows from the one before,
/// and where the robot changes its direction the body does not turn.
void expect_drivable(const OutlinePath& path, double minimum_radius_m) {
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    const PathSample& sample = path.samples[i];
    EXPECT_EQ(sample.turn_on_spot_rad, 0.0);
    EXPECT_LE(std::fabs(sample.curvature_per_m), 1.0 / minimum_radius_m);
    if (i + 1 == path.samples.size()) break;
    const PathSample& next = path.samples[i + 1];
    const double step_m = next.distance_m - sample.distance_m;
    const double turned_rad =
        geometry::wrap_angle(robot_at(next).theta_rad - robot_at(sample).theta_rad);
    // Left of the travel is the left turn of the body, ahead as well as back.
    EXPECT_NEAR(turned_rad, sample.curvature_per_m * step_m, 1e-9);
    EXPECT_NEAR((next.T_map_robot.position_m() - sample.T_map_robot.position_m()).norm(), step_m,
                2e-4);
  }
}

TEST(OutlinePlanner, ACarTurnsInThreePoints) {
  const FreeSpace space(two_rooms());
  const OutlineConfig config = car();
  const OutlinePath path =
      plan_outline(space, {2.0, 2.0, 0.0}, {{2.0, 2.0}, std::numbers::pi}, {}, config);
  ASSERT_TRUE(path.found()) << path.reason;
  expect_drivable(path, config.minimum_radius_m);
  int reversals = 0;
  for (std::size_t i = 1; i < path.samples.size(); ++i) {
    reversals += path.samples[i].backward != path.samples[i - 1].backward ? 1 : 0;
  }
  EXPECT_GE(reversals, 1);
  EXPECT_GT(least_clearance_m(space.grid(), path, config.footprint), config.margin_m - 0.03);
  const PathSample& end = path.samples.back();
  EXPECT_NEAR((end.T_map_robot.position_m() - Eigen::Vector2d(2.0, 2.0)).norm(), 0.0, 0.01);
  EXPECT_NEAR(std::fabs(robot_at(end).theta_rad), std::numbers::pi, 0.01);
}

TEST(OutlinePlanner, ACarGoesThroughANarrowDoor) {
  const FreeSpace space(two_rooms());
  const OutlineConfig config = car();
  for (const double start_rad : {kQuarter, -kQuarter, std::numbers::pi}) {
    const OutlinePath path =
        plan_outline(space, {1.2, 1.2, start_rad}, {{7.0, 3.0}, -kQuarter}, {}, config);
    ASSERT_TRUE(path.found()) << path.reason;
    expect_drivable(path, config.minimum_radius_m);
    EXPECT_GT(least_clearance_m(space.grid(), path, config.footprint), config.margin_m - 0.03);
    EXPECT_NEAR(robot_at(path.samples.back()).theta_rad, -kQuarter, 0.01);
  }
}

TEST(OutlinePlanner, ACarIsRefusedWhereOnlyATurnOnTheSpotLeads) {
  // At the end of a passage it turns in the room and comes back.
  OccupancyGrid grid = two_rooms(30);
  fill_box(grid, {72, 15}, {72, 25}, CellState::kOccupied);
  const FreeSpace space(std::move(grid));
  const PoseGoal goal{{6.0, 2.05}, std::numbers::pi};
  const OutlinePath path = plan_outline(space, {6.0, 2.05, 0.0}, goal, {}, car());
  ASSERT_TRUE(path.found()) << path.reason;
  expect_drivable(path, 0.8);
  // A closed room of 1.4 x 1.4 m, in which the rectangle has room to turn and none to drive.
  OccupancyGrid cell = grid_of_text(std::vector<std::string>(16, std::string(16, '.')), 0.1);
  fill_box(cell, {0, 0}, {15, 0}, CellState::kOccupied);
  fill_box(cell, {0, 15}, {15, 15}, CellState::kOccupied);
  fill_box(cell, {0, 0}, {0, 15}, CellState::kOccupied);
  fill_box(cell, {15, 0}, {15, 15}, CellState::kOccupied);
  const FreeSpace closed(std::move(cell));
  const geometry::Pose2 start{0.8, 0.8, 0.0};
  const PoseGoal across{{0.8, 0.8}, kQuarter};
  OutlineConfig turning = rectangle();
  OutlineConfig driving = car();
  turning.margin_m = driving.margin_m = 0.06;
  EXPECT_TRUE(plan_outline(closed, start, across, {}, turning).found());
  const OutlinePath refused = plan_outline(closed, start, across, {}, driving);
  EXPECT_EQ(refused.status, OutlineStatus::kUnreachable);
  EXPECT_NE(refused.reason.find("cannot turn within 0.80 m"), std::string::npos) << refused.reason;
}

TEST(OutlinePlanner, OnlyTurnsWhereItIsAtTheGoal) {
  const FreeSpace space(two_rooms());
  const OutlinePath path = plan_outline(space, {2.0, 2.0, 0.0}, {{2.0, 2.0}, 3.0}, {}, rectangle());
  ASSERT_TRUE(path.found()) << path.reason;
  EXPECT_EQ(path.samples.back().distance_m, 0.0);
}

}  // namespace
}  // namespace topogeo::planning
