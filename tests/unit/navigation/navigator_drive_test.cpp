#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

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

TEST(NavigatorDrive, KeepsToTheSpeedOfASlowZoneAndOutOfANoGoZone) {
  using planning::ZoneKind;
  DriveSettings settings = from(1.0, 3.0, 0.0);
  settings.noise = true;
  TestDrive drive(room(), settings);
  // The slow zone reaches from wall to wall.
  const std::vector<planning::DrawnZone> zones = {
      {"ramp", {{3.0, -1.0}, {5.0, -1.0}, {5.0, 7.0}, {3.0, 7.0}}, ZoneKind::kSlow, 0.2},
      {"wet", {{5.6, 2.0}, {6.2, 2.0}, {6.2, 4.0}, {5.6, 4.0}}, ZoneKind::kNoGo, 0.0}};
  planning::FreeSpace space(drive.map->space().grid(), drive.map->space().inflation(), zones);
  planning::ZoneMap parts = planning::zones_by_width(space);
  drive.map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(parts));
  drive.navigator.set_map(drive.map, ++drive.map_version);
  drive.go_to({7.0, 3.0});
  double fastest_in = 0.0;
  double fastest_out = 0.0;
  const auto arrived = [&] {
    const Eigen::Vector2d at = drive.robot.T_world_robot().position_m();
    EXPECT_FALSE(at.x() > 5.6 && at.x() < 6.2 && at.y() > 2.0 && at.y() < 4.0) << at.transpose();
    double& fastest = at.x() > 3.03 && at.x() < 4.97 ? fastest_in : fastest_out;
    fastest = std::max(fastest, drive.robot.velocity().linear_m_per_s);
    return drive.status().state == NavigatorState::kArrived;
  };
  ASSERT_TRUE(drive.run_until(arrived, 90.0)) << drive.status().message;
  EXPECT_LT(fastest_in, 0.23);
  EXPECT_GT(fastest_out, 0.4);
  EXPECT_EQ(drive.robot.collisions(), 0U);
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
