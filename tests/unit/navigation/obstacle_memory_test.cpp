#include "obstacle_memory.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "post_scan.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

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
  EXPECT_TRUE(memory.all().empty());  // seen only once
  for (int i = 1; i < 10; ++i) {
    now_ns += kSecond_ns / 10;
    memory.add(scan_of_post(2.0, now_ns), T_map_robot, map->space());
  }
  ASSERT_FALSE(standing_m(memory).empty());
  for (const Eigen::Vector2d& point_m : standing_m(memory)) {
    EXPECT_NEAR(point_m.x(), 4.0, 0.05);
    EXPECT_NEAR(point_m.y(), 3.0, 0.15);
  }
  // The robot turns away: obstacles remain. It turns back, and they are gone.
  ScanPoints away = scan_of_post(6.0, now_ns + 1);
  memory.add(away, T_map_robot * geometry::Pose2{0.0, 0.0, 3.0}, map->space());
  EXPECT_FALSE(standing_m(memory).empty());
  for (int i = 0; i < 4; ++i) {
    now_ns += kSecond_ns / 10;
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
    scan.stamp_ns = k * kSecond_ns / 10;
    memory.add(scan, {5.9, 3.0, 0.01}, map->space());  // the wall is at 8 m
  }
  EXPECT_TRUE(memory.all().empty());
}

TEST(ObstacleMemory, WhatMovesDoesNotStand) {
  const auto map = map_of(room());
  ObstacleMemory memory{MemoryConfig{}};
  for (int k = 0; k < 15; ++k) {
    memory.add(scan_of_post(1.0 + 0.08 * k, k * kSecond_ns / 10), {2.0, 3.0, 0.0}, map->space());
  }
  EXPECT_TRUE(standing_m(memory).empty());
}

}  // namespace
}  // namespace topogeo::navigation
