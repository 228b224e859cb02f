#include "topogeo/simulation/contact.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::simulation {
namespace {

world::World with(std::vector<world::Segment> segments, std::vector<world::Circle> circles = {}) {
  world::World world;
  world.segments = std::move(segments);
  world.circles = std::move(circles);
  return world;
}

Eigen::Vector2d direction(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

TEST(FreePath, EndsWhereTheDiscTouches) {
  const world::World wall = with({{{2, -1}, {2, 1}}});
  const FreePath ahead = free_path(wall, {0, 0}, {1, 0}, 5.0, 0.5);
  EXPECT_NEAR(ahead.distance_m, 1.5, 1e-12);
  ASSERT_TRUE(ahead.contact_m);
  EXPECT_NEAR((*ahead.contact_m - Eigen::Vector2d(2, 0)).norm(), 0.0, 1e-12);
  // The end of the wall meets the disc's rim: 0.3 beside its centre, 0.4 ahead of it.
  const FreePath corner = free_path(wall, {0, 1.3}, {1, 0}, 5.0, 0.5);
  EXPECT_NEAR(corner.distance_m, 1.6, 1e-12);
  EXPECT_FALSE(free_path(wall, {0, 1.6}, {1, 0}, 5.0, 0.5).contact_m);
  EXPECT_FALSE(free_path(wall, {0, 0}, {-1, 0}, 5.0, 0.5).contact_m);
  const FreePath short_of = free_path(wall, {0, 0}, {1, 0}, 1.4, 0.5);
  EXPECT_FALSE(short_of.contact_m);
  EXPECT_DOUBLE_EQ(short_of.distance_m, 1.4);
}

TEST(FreePath, ColumnsAreSolid) {
  const world::World column = with({}, {{{3, 0}, 0.5}});
  const FreePath ahead = free_path(column, {0, 0}, {1, 0}, 5.0, 0.5);
  EXPECT_NEAR(ahead.distance_m, 2.0, 1e-12);
  ASSERT_TRUE(ahead.contact_m);
  EXPECT_NEAR((*ahead.contact_m - Eigen::Vector2d(2.5, 0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(free_path(column, {2.9, 0}, {1, 0}, 5.0, 0.5).distance_m, 0.0);  // inside it
  EXPECT_EQ(free_path(column, {2.9, 0}, {-1, 0}, 5.0, 0.5).distance_m, 5.0);
}

TEST(FreePath, WhatIsTouchedLetsTheDiscGoAwayAndAlong) {
  const world::World wall = with({{{1, -9}, {1, 9}}});
  EXPECT_EQ(free_path(wall, {0.5, 0}, {1, 0}, 1.0, 0.5).distance_m, 0.0);
  EXPECT_EQ(free_path(wall, {0.5, 0}, {0, 1}, 1.0, 0.5).distance_m, 1.0);
  EXPECT_EQ(free_path(wall, {0.5, 0}, {-1, 0}, 1.0, 0.5).distance_m, 1.0);
  // A door that has shut on the disc.
  EXPECT_EQ(free_path(wall, {0.8, 0}, {1, 0}, 1.0, 0.5).distance_m, 0.0);
  EXPECT_EQ(free_path(wall, {0.8, 0}, {-1, 0}, 1.0, 0.5).distance_m, 1.0);
}

// Compared with moving forward in small steps.
TEST(FreePath, IsThatOfADiscThatCreeps) {
  constexpr double kStep_m = 1e-3;
  support::Random random(5);
  int stopped = 0;
  for (int round = 0; round < 200; ++round) {
    world::World world;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector2d a_m(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0));
      const double angle_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
      world.segments.push_back({a_m, a_m + random.uniform(0.1, 2.0) * direction(angle_rad)});
      world.circles.push_back({{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)}, 0.2});
    }
    const double radius_m = random.uniform(0.05, 0.4);
    const Eigen::Vector2d from_m(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    if (clearance_m(world, from_m) < radius_m + 0.01 || overlap_m(world, from_m, radius_m)) {
      continue;
    }
    const Eigen::Vector2d ahead = direction(random.uniform(0.0, 2.0 * std::numbers::pi));
    const FreePath way = free_path(world, from_m, ahead, 4.0, radius_m);
    double crept_m = 0.0;
    while (crept_m < 4.0 && clearance_m(world, from_m + crept_m * ahead) >= radius_m) {
      crept_m += kStep_m;
    }
    // At a grazing contact the small steps may miss it.
    if (way.contact_m && crept_m > way.distance_m + 2.0 * kStep_m) {
      EXPECT_NEAR(clearance_m(world, from_m + way.distance_m * ahead), radius_m, 1e-9);
      continue;
    }
    EXPECT_NEAR(way.distance_m, std::min(crept_m, 4.0), 1.1 * kStep_m) << round;
    stopped += way.contact_m ? 1 : 0;
  }
  EXPECT_GT(stopped, 30);
}

}  // namespace
}  // namespace topogeo::simulation
