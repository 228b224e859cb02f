// Obstacles near a robot in a room of 8 x 6 m.
#include "surroundings.hpp"

#include <gtest/gtest.h>

#include "post_scan.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

class SurroundingsTest : public testing::Test {
 protected:
  /// Scans of a post 2 m ahead, ten in a second, from a robot at 2, 3.
  void see_post(int scans) {
    for (int i = 0; i < scans; ++i) {
      now_ns += kSecond_ns / 10;
      poses.add(OdometrySample{now_ns, {}});
      PoseFix fix;
      fix.stamp_ns = now_ns;
      fix.T_map_robot = {2.0, 3.0, 0.0};
      fix.tracking = true;
      poses.add(fix);
      surroundings.add(scan_of_post(2.0, now_ns));
      surroundings.update(&map->space(), poses, now_ns);
    }
  }

  std::shared_ptr<const planning::HybridMap> map = map_of(room());
  PoseKeeper poses{PoseKeeperConfig{}};
  Surroundings surroundings{60.0};
  std::int64_t now_ns = 0;
};

TEST_F(SurroundingsTest, WhatStandsComesFirst) {
  see_post(3);
  EXPECT_FALSE(surroundings.seen(now_ns).points_m.empty());
  EXPECT_EQ(surroundings.seen(now_ns).standing, 0U);
  see_post(10);
  surroundings.add_contact({5.0, 5.0}, now_ns);
  const SeenObstacles seen = surroundings.seen(now_ns);
  ASSERT_GT(seen.standing, 1U);
  EXPECT_EQ(seen.standing_m().back(), Eigen::Vector2d(5.0, 5.0));
  EXPECT_NEAR(seen.standing_m().front().x(), 4.0, 0.1);
}

TEST_F(SurroundingsTest, WithoutMapOrPoseScansAreDropped) {
  surroundings.add(scan_of_post(2.0, 1));
  surroundings.update(nullptr, poses, 1);
  see_post(1);
  EXPECT_TRUE(surroundings.seen(now_ns).points_m.empty());  // it takes two scans
}

TEST_F(SurroundingsTest, ForgetsWhatWasPlacedByAWrongPose) {
  see_post(10);
  surroundings.add_contact({5.0, 5.0}, now_ns);
  surroundings.forget();
  EXPECT_TRUE(surroundings.seen(now_ns).points_m.empty());
}

TEST_F(SurroundingsTest, ReportsWhatIsAroundAPointAndEachTimeAnew) {
  see_post(10);
  surroundings.add_contact({5.0, 5.0}, now_ns);
  EXPECT_FALSE(surroundings.anything_reported());
  surroundings.report({5.0, 5.0}, 1.0, map->frame(), now_ns);
  EXPECT_TRUE(surroundings.anything_reported());
  EXPECT_EQ(surroundings.blockages().version, 1U);
  ASSERT_EQ(surroundings.blockages().points_m.size(), 1U);
  EXPECT_LT((surroundings.blockages().points_m[0] - Eigen::Vector2d(5.0, 5.0)).norm(), 0.1);
  surroundings.report({5.0, 5.0}, 1.0, map->frame(), now_ns);
  EXPECT_EQ(surroundings.blockages().version, 2U);  // so that the planner answers again
  EXPECT_EQ(surroundings.blockages().points_m.size(), 1U);
}

}  // namespace
}  // namespace topogeo::navigation
