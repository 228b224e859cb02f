#include "blockade.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

TEST(Blockade, CountsItsChanges) {
  const planning::GridFrame frame{100, 100, 0.1, {}};
  Blockade blockade(60.0);
  EXPECT_EQ(blockade.report().version, 0U);
  const std::vector<Eigen::Vector2d> points_m = {{2.01, 1.02}, {2.04, 1.07}, {2.12, 1.0}};
  EXPECT_TRUE(blockade.add(points_m, frame, 0));
  EXPECT_EQ(blockade.report().version, 1U);
  ASSERT_EQ(blockade.report().points_m.size(), 2U);  // two are in one cell
  EXPECT_NEAR(blockade.report().points_m[0].x(), 2.05, 1e-9);
  EXPECT_FALSE(blockade.add(points_m, frame, 30 * kSecond_ns));
  EXPECT_EQ(blockade.report().version, 1U);
  blockade.expire(80 * kSecond_ns);  // seen 50 s ago
  EXPECT_EQ(blockade.report().version, 1U);
  blockade.expire(91 * kSecond_ns);
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

}  // namespace
}  // namespace topogeo::navigation
