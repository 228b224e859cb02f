// The parts of the navigator by themselves.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

#include "arc_sweep.hpp"
#include "base_watch.hpp"
#include "blockade.hpp"
#include "contact_memory.hpp"
#include "obstacle_memory.hpp"
#include "path_band.hpp"
#include "pose_keeper.hpp"
#include "scan_occupancy.hpp"
#include "scan_smoothing.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

constexpr std::int64_t kOneSecond_ns = 1'000'000'000;

TEST(ArcSweep, StraightToAPoint) {
  const std::vector<Eigen::Vector2d> points_m = {{2.0, 0.3}, {1.5, 0.6}};
  const SweptWay way = sweep({0.5, 0.0}, points_m, 0.5, 5.0);
  EXPECT_NEAR(way.way_m, 2.0 - 0.4, 1e-12);
  EXPECT_EQ(way.contact, 0U);
  EXPECT_NEAR(sweep({0.5, 0.0}, points_m, 0.5, 1.0).way_m, 1.0, 1e-12);
  EXPECT_NEAR(sweep({-0.5, 0.0}, points_m, 0.5, 5.0).way_m, 5.0, 1e-12);
}

TEST(ArcSweep, AQuarterCircle) {
  // A point on the circle of 1 m to the left, a quarter round; the disc of 0.1 m meets it earlier.
  const std::vector<Eigen::Vector2d> points_m = {{1.0, 1.0}};
  const double before_rad = 2.0 * std::asin(0.05);
  EXPECT_NEAR(sweep({1.0, 1.0}, points_m, 0.1, 5.0).way_m, 0.5 * std::numbers::pi - before_rad,
              1e-9);
  EXPECT_NEAR(sweep({1.0, -1.0}, points_m, 0.1, 5.0).way_m, 5.0, 1e-9);
}

TEST(ArcSweep, AgreesWithFineSteps) {
  support::Random random(3);
  int met = 0;
  for (int run = 0; run < 500; ++run) {
    const geometry::Velocity motion{random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)};
    const double radius_m = random.uniform(0.05, 0.5);
    const Eigen::Vector2d point_m(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    if (point_m.norm() < radius_m || std::fabs(motion.linear_m_per_s) < 0.05) continue;
    const std::vector<Eigen::Vector2d> points_m = {point_m};
    constexpr double kLimit_m = 2.0;
    const double way_m = sweep(motion, points_m, radius_m, kLimit_m).way_m;
    double stepped_m = 0.0;
    constexpr double kPiece_m = 0.0005;
    for (; stepped_m < kLimit_m; stepped_m += kPiece_m) {
      const auto pose = moved(motion, stepped_m / std::fabs(motion.linear_m_per_s));
      if ((pose.position_m() - point_m).norm() < radius_m) break;
    }
    if (stepped_m < kLimit_m) ++met;
    // A point that is only just touched may be missed between two steps.
    if (stepped_m < kLimit_m) {
      EXPECT_NEAR(way_m, stepped_m, 0.002) << "run " << run;
    }
  }
  EXPECT_GT(met, 20);
}

TEST(StoppingSpeed, UsesUpTheWay) {
  EXPECT_EQ(stopping_speed(0.0, 0.3, 0.5), 0.0);
  EXPECT_EQ(stopping_speed(-1.0, 0.3, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(stopping_speed(1.0, 0.0, 0.5), 1.0);
  const double speed = stopping_speed(1.0, 0.3, 0.5);
  EXPECT_NEAR(speed * 0.3 + speed * speed, 1.0, 1e-12);
}

TEST(ScanSmoothing, TakesNoiseOffAWallAndLeavesLonePoints) {
  support::Random random(5);
  ScanPoints scan;
  for (int i = -90; i <= 90; ++i) {
    const double bearing_rad = 0.005 * i;
    const double range_m = 2.0 / std::cos(bearing_rad) + 0.02 * random.normal();
    scan.points_m.emplace_back(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
  }
  scan.points_m.emplace_back(0.0, 1.0);
  const ScanPoints result = smoothed(scan, 0.02);
  double before_m = 0.0;
  double after_m = 0.0;
  for (std::size_t i = 0; i + 1 < scan.points_m.size(); ++i) {
    before_m += std::fabs(scan.points_m[i].x() - 2.0);
    after_m += std::fabs(result.points_m[i].x() - 2.0);
    EXPECT_LE((scan.points_m[i] - result.points_m[i]).norm(), 0.02 + 1e-9);
  }
  EXPECT_LT(after_m, 0.7 * before_m);
  EXPECT_EQ(result.points_m.back(), scan.points_m.back());
}

TEST(ScanOccupancy, SeesFreeOccupiedAndHidden) {
  ScanPoints scan;
  for (int i = -100; i <= 100; ++i) scan.points_m.emplace_back(2.0, 0.01 * i);
  const ScanOccupancy occupancy(scan);
  EXPECT_EQ(occupancy.at({1.0, 0.0}, 0.05), Occupancy::kFree);
  EXPECT_EQ(occupancy.at({2.0, 0.5}, 0.05), Occupancy::kOccupied);
  EXPECT_EQ(occupancy.at({3.0, 0.0}, 0.05), Occupancy::kUnseen);
  EXPECT_EQ(occupancy.at({-1.0, 0.0}, 0.05), Occupancy::kUnseen);
  EXPECT_EQ(occupancy.at({1.0, 1.0}, 0.05), Occupancy::kUnseen);  // beside the beams
}

ScanPoints scan_of_post(double x_m, std::int64_t stamp_ns) {
  ScanPoints scan;
  scan.stamp_ns = stamp_ns;
  for (int i = -60; i <= 60; ++i) {
    const double bearing_rad = 0.01 * i;
    const double range_m = std::abs(i) <= 5 ? x_m : 6.0;
    scan.points_m.emplace_back(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
  }
  return scan;
}

std::vector<Eigen::Vector2d> standing_m(const ObstacleMemory& memory) {
  std::vector<Eigen::Vector2d> points_m;
  for (const Obstacle& obstacle : memory.all()) {
    if (obstacle.stands) points_m.push_back(obstacle.point_m);
  }
  return points_m;
}

TEST(ObstacleMemory, KeepsWhatStandsAndForgetsWhatHasGone) {
  const auto map = map_of(room());
  ObstacleMemory memory{MemoryConfig{}};
  const geometry::Pose2 T_map_robot{2.0, 3.0, 0.0};
  std::int64_t now_ns = 0;
  memory.add(scan_of_post(2.0, now_ns), T_map_robot, map->space());
  EXPECT_TRUE(memory.all().empty());  // seen once
  for (int i = 1; i < 10; ++i) {
    now_ns += kOneSecond_ns / 10;
    memory.add(scan_of_post(2.0, now_ns), T_map_robot, map->space());
  }
  ASSERT_FALSE(standing_m(memory).empty());
  for (const Eigen::Vector2d& point_m : standing_m(memory)) {
    EXPECT_NEAR(point_m.x(), 4.0, 0.05);
    EXPECT_NEAR(point_m.y(), 3.0, 0.15);
  }
  // It looks away: what it saw stays. It looks again, and it has gone.
  ScanPoints away = scan_of_post(6.0, now_ns + 1);
  memory.add(away, T_map_robot * geometry::Pose2{0.0, 0.0, 3.0}, map->space());
  EXPECT_FALSE(standing_m(memory).empty());
  for (int i = 0; i < 4; ++i) {
    now_ns += kOneSecond_ns / 10;
    memory.add(scan_of_post(6.0, now_ns), T_map_robot, map->space());
  }
  EXPECT_TRUE(memory.all().empty());
}

TEST(ObstacleMemory, WallsOfTheMapAreNoObstaclesWithSomeErrorOfPose) {
  const auto map = map_of(room());
  ObstacleMemory memory{MemoryConfig{}};
  ScanPoints scan;
  for (int i = -50; i <= 50; ++i) scan.points_m.emplace_back(2.0, 0.05 * i);
  for (int k = 0; k < 20; ++k) {
    scan.stamp_ns = k * kOneSecond_ns / 10;
    memory.add(scan, {5.9, 3.0, 0.01}, map->space());  // the wall is at 8 m
  }
  EXPECT_TRUE(memory.all().empty());
}

TEST(ObstacleMemory, WhatMovesDoesNotStand) {
  const auto map = map_of(room());
  ObstacleMemory memory{MemoryConfig{}};
  for (int k = 0; k < 15; ++k) {
    memory.add(scan_of_post(1.0 + 0.08 * k, k * kOneSecond_ns / 10), {2.0, 3.0, 0.0}, map->space());
  }
  EXPECT_TRUE(standing_m(memory).empty());
}

TEST(ContactMemory, TheSameContactAgainPushesNoOtherOut) {
  ContactMemory contacts;
  contacts.add({1.0, 0.0}, 0);
  for (std::int64_t i = 0; i < 50; ++i) contacts.add({2.0, 0.0005 * static_cast<double>(i)}, i);
  ASSERT_EQ(contacts.points_m(50).size(), 2U);
  EXPECT_EQ(contacts.points_m(50).front(), Eigen::Vector2d(1.0, 0.0));
  // Twelve seconds after it was met last a contact counts no more.
  EXPECT_EQ(contacts.points_m(12 * kOneSecond_ns).size(), 1U);
  EXPECT_TRUE(contacts.points_m(12 * kOneSecond_ns + 50).empty());
  for (int i = 0; i < 30; ++i) contacts.add({0.1 * i, 5.0}, 60);
  EXPECT_EQ(contacts.points_m(60).size(), ContactMemory::kMost);
  contacts.clear();
  EXPECT_TRUE(contacts.points_m(60).empty());
}

TEST(Blockade, CountsItsChanges) {
  const planning::GridFrame frame{100, 100, 0.1, {}};
  Blockade blockade(60.0);
  EXPECT_EQ(blockade.report().version, 0U);
  const std::vector<Eigen::Vector2d> points_m = {{2.01, 1.02}, {2.04, 1.07}, {2.12, 1.0}};
  EXPECT_TRUE(blockade.add(points_m, frame, 0));
  EXPECT_EQ(blockade.report().version, 1U);
  ASSERT_EQ(blockade.report().points_m.size(), 2U);  // two are in one cell
  EXPECT_NEAR(blockade.report().points_m[0].x(), 2.05, 1e-9);
  EXPECT_FALSE(blockade.add(points_m, frame, 30 * kOneSecond_ns));
  EXPECT_EQ(blockade.report().version, 1U);
  blockade.expire(80 * kOneSecond_ns);  // seen 50 s ago
  EXPECT_EQ(blockade.report().version, 1U);
  blockade.expire(91 * kOneSecond_ns);
  EXPECT_EQ(blockade.report().version, 2U);
  EXPECT_TRUE(blockade.report().points_m.empty());
}

TEST(Blockade, WhatIsSeenFreeIsTakenBack) {
  const planning::GridFrame frame{100, 100, 0.1, {}};
  Blockade blockade(60.0);
  const std::vector<Eigen::Vector2d> points_m = {{4.0, 3.0}};
  blockade.add(points_m, frame, 0);
  const geometry::Pose2 T_map_robot{2.0, 3.0, 0.0};
  for (int k = 0; k < 4; ++k) blockade.see(scan_of_post(6.0, k), T_map_robot);
  blockade.expire(10);
  EXPECT_FALSE(blockade.empty());
  blockade.see(scan_of_post(2.0, 5), T_map_robot);  // there again
  for (int k = 6; k < 10; ++k) blockade.see(scan_of_post(6.0, k), T_map_robot);
  blockade.expire(20);
  EXPECT_FALSE(blockade.empty());
  blockade.see(scan_of_post(6.0, 11), T_map_robot);
  blockade.expire(20);
  EXPECT_TRUE(blockade.empty());
}

TEST(PoseKeeper, CarriesAnOldFixOnByOdometry) {
  PoseKeeper keeper{PoseKeeperConfig{}};
  keeper.add(OdometrySample{kOneSecond_ns, {0.0, 0.0, 0.0}});
  keeper.add(OdometrySample{2 * kOneSecond_ns, {1.0, 0.0, 0.0}});
  PoseFix fix;
  fix.stamp_ns = kOneSecond_ns + kOneSecond_ns / 2;  // odometry was at 0.5 m
  fix.T_map_robot = {10.0, 5.0, 0.5 * std::numbers::pi};
  fix.tracking = true;
  keeper.add(fix);
  const auto pose = keeper.good_pose(2 * kOneSecond_ns);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 10.0, 1e-9);
  EXPECT_NEAR(pose->y_m, 5.5, 1e-9);
  // A fix that is newer than all odometry waits for it.
  fix.stamp_ns = 3 * kOneSecond_ns;
  fix.T_map_robot = {0.0, 0.0, 0.0};
  keeper.add(fix);
  EXPECT_NEAR(keeper.good_pose(2 * kOneSecond_ns)->y_m, 5.5, 1e-9);
  keeper.add(OdometrySample{3 * kOneSecond_ns, {2.0, 0.0, 0.0}});
  EXPECT_NEAR(keeper.good_pose(3 * kOneSecond_ns)->x_m, 0.0, 1e-9);
  EXPECT_NEAR(keeper.take_jump_m(), std::hypot(10.0, 6.5), 1e-9);
}

TEST(BaseWatch, NoticesABaseThatDoesNotMove) {
  BaseWatch watch(2.0);
  const geometry::Velocity told{0.3, 0.0};
  EXPECT_FALSE(watch.stuck(told, {}, 0));
  EXPECT_FALSE(watch.stuck(told, {0.005, 0.0, 0.0}, 1 * kOneSecond_ns));
  EXPECT_TRUE(watch.stuck(told, {0.005, 0.0, 0.0}, 2 * kOneSecond_ns));
  EXPECT_FALSE(watch.stuck(told, {0.1, 0.0, 0.0}, 3 * kOneSecond_ns));
  EXPECT_FALSE(watch.stuck({}, {0.1, 0.0, 0.0}, 9 * kOneSecond_ns));
  EXPECT_FALSE(watch.stuck({0.0, 0.5}, {0.1, 0.0, 0.0}, 10 * kOneSecond_ns));
  EXPECT_TRUE(watch.stuck({0.0, 0.5}, {0.1, 0.0, 0.0}, 12 * kOneSecond_ns));
}

TEST(PathBand, KeepsOffWallsAndBendsGently) {
  const auto map = map_of(two_doors());
  // Close round the door's posts, as a straightened way goes.
  const std::vector<Eigen::Vector2d> points_m = {
      {4.0, 3.5}, {4.65, 1.85}, {5.35, 1.85}, {6.0, 3.5}};
  const BandConfig config;
  const auto way_m = band(map->space(), points_m, {}, config);
  ASSERT_GT(way_m.size(), 20U);
  EXPECT_EQ(way_m.front(), points_m.front());
  EXPECT_EQ(way_m.back(), points_m.back());
  const world::World world = two_doors();
  for (const Eigen::Vector2d& point_m : way_m) {
    EXPECT_GT(world::clearance_m(world, point_m), config.least_m);
  }
  for (const auto& sample : samples_of(way_m, 0.9)) {
    EXPECT_EQ(sample.turn_on_spot_rad, 0.0);
    EXPECT_LT(std::fabs(sample.curvature_per_m), 6.0);
  }
}

TEST(PathBand, AWayThroughAnObstacleIsNone) {
  const auto map = map_of(room());
  const std::vector<Eigen::Vector2d> points_m = {{1.0, 3.0}, {7.0, 3.0}};
  EXPECT_FALSE(band(map->space(), points_m, {}, BandConfig{}).empty());
  const std::vector<Eigen::Vector2d> wall_m = {{4.0, 2.8}, {4.0, 2.9}, {4.0, 3.0}, {4.0, 3.1}};
  EXPECT_TRUE(band(map->space(), points_m, wall_m, BandConfig{}).empty());
}

}  // namespace
}  // namespace topogeo::navigation
