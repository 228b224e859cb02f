#include "topogeo/planning/motion_primitives.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/planning/hybrid_planner.hpp"

#include "floors.hpp"

namespace topogeo::planning {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(MotionPrimitives, TurnAndAdvanceAlongAPolyline) {
  const std::vector<Eigen::Vector2d> points_m{{0, 0}, {2, 0}, {3, 0}, {3, 4}, {4, 4}};
  const auto primitives = motion_primitives(points_m, kPi / 2, kPi);
  ASSERT_EQ(primitives.size(), 7U);
  const auto expect = [&](std::size_t i, MotionKind kind, double amount) {
    EXPECT_EQ(primitives[i].kind, kind);
    EXPECT_NEAR(primitives[i].amount, amount, 1e-12);
  };
  expect(0, MotionKind::kTurnRight, kPi / 2);
  expect(1, MotionKind::kAdvance, 3.0);
  expect(2, MotionKind::kTurnLeft, kPi / 2);
  expect(3, MotionKind::kAdvance, 4.0);
  expect(4, MotionKind::kTurnRight, kPi / 2);
  expect(5, MotionKind::kAdvance, 1.0);
  expect(6, MotionKind::kTurnLeft, kPi);
}

TEST(MotionPrimitives, LeaveOutWhatIsNothing) {
  EXPECT_TRUE(motion_primitives({}, 0.0).empty());
  const std::vector<Eigen::Vector2d> still_m{{1, 1}, {1, 1}};
  EXPECT_TRUE(motion_primitives(still_m, 0.3).empty());
  EXPECT_EQ(motion_primitives(still_m, 0.0, 0.5).size(), 1U);
}

TEST(MotionPrimitives, TakeARobotToTheEndOfAnyPolyline) {
  support::Random random(9);
  for (int round = 0; round < 50; ++round) {
    std::vector<Eigen::Vector2d> points_m(8);
    for (Eigen::Vector2d& p : points_m) p = {random.uniform(-5, 5), random.uniform(-5, 5)};
    const double heading_rad = random.uniform(-3, 3);
    PrimitiveConfig config;
    config.min_turn_rad = 0.0;
    const auto primitives = motion_primitives(points_m, heading_rad, 1.0, config);
    const geometry::Pose2 end =
        pose_after({points_m[0].x(), points_m[0].y(), heading_rad}, primitives);
    EXPECT_NEAR((end.position_m() - points_m.back()).norm(), 0.0, 1e-9);
    EXPECT_NEAR(end.theta_rad, 1.0, 1e-9);
    for (const MotionPrimitive& primitive : primitives) EXPECT_GT(primitive.amount, 0.0);
  }
}

TEST(MotionPrimitives, RefuseBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector2d> bad_m{{0, 0}, {nan, 0}};
  EXPECT_THROW(motion_primitives(bad_m, 0.0), std::invalid_argument);
  EXPECT_THROW(motion_primitives({}, nan), std::invalid_argument);
  EXPECT_THROW(motion_primitives({}, 0.0, nan), std::invalid_argument);
}

FreeSpace hall() {
  return FreeSpace(grid_of_text(std::vector<std::string>(60, std::string(60, '.')), 0.1));
}

TEST(SmoothPath, RoundsACornerWithAnArc) {
  const std::vector<Eigen::Vector2d> corner_m{{1, 1}, {3, 1}, {3, 4}};
  SmoothPathConfig config;
  config.max_radius_m = 0.5;
  const auto path = smooth_path(hall(), corner_m, config);
  ASSERT_FALSE(path.empty());
  EXPECT_NEAR((path.back().T_map_robot.position_m() - corner_m.back()).norm(), 0.0, 1e-9);
  EXPECT_NEAR(path.back().T_map_robot.theta_rad, kPi / 2, 1e-9);
  EXPECT_NEAR(path.back().distance_m, 5.0 - 1.0 + 0.5 * kPi / 2, 1e-6);
  double most = 0.0;
  for (const PathSample& sample : path) {
    most = std::max(most, sample.curvature_per_m);
    EXPECT_EQ(sample.turn_on_spot_rad, 0.0);
    if (sample.curvature_per_m != 0.0) {
      EXPECT_NEAR((sample.T_map_robot.position_m() - Eigen::Vector2d(2.5, 1.5)).norm(), 0.5, 1e-9);
    }
  }
  EXPECT_DOUBLE_EQ(most, 2.0);
}

TEST(SmoothPath, TurnsOnTheSpotWhereThereIsNoRoom) {
  const std::vector<Eigen::Vector2d> hairpin_m{{1, 1}, {3, 1}, {1, 1.01}};
  const auto path = smooth_path(hall(), hairpin_m);
  double turned_rad = 0.0;
  for (const PathSample& sample : path) turned_rad += std::fabs(sample.turn_on_spot_rad);
  EXPECT_NEAR(turned_rad, kPi, 0.01);
}

TEST(SmoothPath, StaysPassableAndWithinItsCurvatureOnRandomRoutes) {
  const BlockFloor floor = block_floor({}, 17);
  const FreeSpace space(floor.grid);
  support::Random random(1);
  SmoothPathConfig config;
  config.min_radius_m = 0.25;
  for (int k = 0; k < 40; ++k) {
    const HybridRoute route =
        plan_on_grid(space, random_free_point_m(space, random), random_free_point_m(space, random));
    ASSERT_TRUE(route.found());
    if (route.points_m.size() < 2) continue;
    const auto path = smooth_path(space, route.points_m, config);
    ASSERT_FALSE(path.empty());
    EXPECT_LE(path.back().distance_m, route.length_m + 1e-9);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto cell = space.frame().cell_of(path[i].T_map_robot.position_m());
      ASSERT_TRUE(cell && space.passable(*cell));
      ASSERT_LE(std::fabs(path[i].curvature_per_m), 1.0 / config.min_radius_m + 1e-9);
      if (i == 0) continue;
      const PathSample& last = path[i - 1];
      ASSERT_LE(path[i].distance_m - last.distance_m, config.step_m + 1e-9);
      // The heading changes only by the curvature and by turns on the spot.
      const double expected_rad = last.T_map_robot.theta_rad +
                                  last.curvature_per_m * (path[i].distance_m - last.distance_m) +
                                  path[i].turn_on_spot_rad;
      ASSERT_NEAR(geometry::wrap_angle(path[i].T_map_robot.theta_rad - expected_rad), 0.0, 1e-6);
    }
  }
}

TEST(SmoothPath, RefusesBadInput) {
  SmoothPathConfig config;
  config.max_radius_m = 0.1;
  EXPECT_THROW(check(config), std::invalid_argument);
  EXPECT_TRUE(smooth_path(hall(), std::vector<Eigen::Vector2d>{{1, 1}}).empty());
}

TEST(Straighten, DoesNotCutThroughWhatIsForbidden) {
  InflationConfig inflation;
  inflation.forbidden_cells = 0.0;
  const FreeSpace space(grid_of_text({
                            "....",  //
                            ".##.",  //
                            "....",  //
                        }),
                        inflation);
  const std::vector<Cell> cells{{0, 0}, {0, 1}, {0, 2}, {1, 2}, {2, 2}, {3, 2}};
  const auto path_m = straighten(space, cells, {0.5, 0.5}, {3.5, 2.5});
  EXPECT_EQ(path_m, (std::vector<Eigen::Vector2d>{{0.5, 0.5}, {0.5, 2.5}, {3.5, 2.5}}));
  EXPECT_FALSE(in_sight(space, {0.5, 0.5}, {3.5, 2.5}));
  EXPECT_FALSE(in_sight(space, {0.5, 0.5}, {9.5, 0.5}));
}

}  // namespace
}  // namespace topogeo::planning
