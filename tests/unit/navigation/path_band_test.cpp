#include "path_band.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

TEST(PathBand, KeepsOffWallsAndBendsGently) {
  const auto map = map_of(two_doors());
  // Close round the door's posts, like a straightened path.
  const std::vector<Eigen::Vector2d> points_m = {
      {4.0, 3.5}, {4.65, 1.85}, {5.35, 1.85}, {6.0, 3.5}};
  const BandConfig config;
  const auto path_m = band(map->space(), points_m, {}, config);
  ASSERT_GT(path_m.size(), 20U);
  EXPECT_EQ(path_m.front(), points_m.front());
  EXPECT_EQ(path_m.back(), points_m.back());
  const world::World world = two_doors();
  for (const Eigen::Vector2d& point_m : path_m) {
    EXPECT_GT(world::clearance_m(world, point_m), config.least_m);
  }
  for (const auto& sample : samples_of(path_m, 0.9)) {
    EXPECT_EQ(sample.turn_on_spot_rad, 0.0);
    EXPECT_LT(std::fabs(sample.curvature_per_m), 6.0);
  }
}

TEST(PathBand, APathThroughAnObstacleIsNone) {
  const auto map = map_of(room());
  const std::vector<Eigen::Vector2d> points_m = {{1.0, 3.0}, {7.0, 3.0}};
  EXPECT_FALSE(band(map->space(), points_m, {}, BandConfig{}).empty());
  const std::vector<Eigen::Vector2d> wall_m = {{4.0, 2.8}, {4.0, 2.9}, {4.0, 3.0}, {4.0, 3.1}};
  EXPECT_TRUE(band(map->space(), points_m, wall_m, BandConfig{}).empty());
}

}  // namespace
}  // namespace topogeo::navigation
