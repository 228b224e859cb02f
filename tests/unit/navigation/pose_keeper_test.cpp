#include "pose_keeper.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

TEST(PoseKeeper, CarriesAnOldFixOnByOdometry) {
  PoseKeeper keeper{PoseKeeperConfig{}};
  keeper.add(OdometrySample{kSecond_ns, {0.0, 0.0, 0.0}});
  keeper.add(OdometrySample{2 * kSecond_ns, {1.0, 0.0, 0.0}});
  PoseFix fix;
  fix.stamp_ns = kSecond_ns + kSecond_ns / 2;  // odometry was at 0.5 m
  fix.T_map_robot = {10.0, 5.0, 0.5 * std::numbers::pi};
  fix.tracking = true;
  keeper.add(fix);
  const auto pose = keeper.good_pose(2 * kSecond_ns);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 10.0, 1e-9);
  EXPECT_NEAR(pose->y_m, 5.5, 1e-9);
  // A fix newer than all odometry waits for odometry.
  fix.stamp_ns = 3 * kSecond_ns;
  fix.T_map_robot = {0.0, 0.0, 0.0};
  keeper.add(fix);
  EXPECT_NEAR(keeper.good_pose(2 * kSecond_ns)->y_m, 5.5, 1e-9);
  keeper.add(OdometrySample{3 * kSecond_ns, {2.0, 0.0, 0.0}});
  EXPECT_NEAR(keeper.good_pose(3 * kSecond_ns)->x_m, 0.0, 1e-9);
  EXPECT_NEAR(keeper.take_jump_m(), std::hypot(10.0, 6.5), 1e-9);
}

}  // namespace
}  // namespace topogeo::navigation
