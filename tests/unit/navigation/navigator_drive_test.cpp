#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

DriveSettings from(double x_m, double y_m, double heading_rad) {
  DriveSettings settings;
  settings.T_world_start = {x_m, y_m, heading_rad};
  return settings;
}

TEST(NavigatorDrive, ArrivesInAFreeRoom) {
  TestDrive drive(room(), from(1.0, 1.0, 0.0));
  drive.go_to({6.5, 4.5}, std::numbers::pi / 2.0);
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.05);
  EXPECT_NEAR(drive.robot.T_world_robot().theta_rad, std::numbers::pi / 2.0, 0.04);
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_EQ(drive.status().guard_stops, 0U);
  EXPECT_EQ(drive.command, geometry::Velocity{});
  EXPECT_NEAR(drive.status().driven_m, std::hypot(5.5, 3.5), 0.3);
  EXPECT_EQ(drive.status().routes, 1U);
}

TEST(NavigatorDrive, ArrivesThroughADoorWithNoise) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    DriveSettings settings = from(2.0, 5.0, 0.0);
    settings.noise = true;
    settings.seed = seed;
    TestDrive drive(two_doors(), settings);
    drive.go_to({8.5, 1.0}, 0.0);
    ASSERT_TRUE(drive.arrives(90.0)) << drive.status().message << " seed " << seed;
    EXPECT_LT(drive.off_m(), 0.08);
    EXPECT_EQ(drive.robot.collisions(), 0U);
  }
}

TEST(NavigatorDrive, ArrivesInPrimitives) {
  DriveSettings settings = from(2.0, 5.0, 2.0);
  settings.navigator.motion = MotionStyle::kPrimitives;
  TestDrive drive(two_doors(), settings);
  drive.go_to({8.5, 1.0}, 0.0);
  ASSERT_TRUE(drive.arrives(120.0)) << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.05);
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

}  // namespace
}  // namespace topogeo::navigation
