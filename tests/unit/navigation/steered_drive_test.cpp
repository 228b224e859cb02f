// Drives of a robot of 1.2 x 0.6 m that cannot turn within 0.8 m, on a drawn floor with doors of
// 0.9 m and noise: a short form of topogeo_outline_drives --radius 0.8.
#include <cmath>

#include <gtest/gtest.h>

#include "outline_task.hpp"

namespace topogeo::navigation {
namespace {

constexpr OutlineBase kCar{0.8, 0.0};

/// Drives until the robot arrives; every command must be one that the base can drive.
bool arrives(TestDrive& drive, double radius_m) {
  bool drivable = true;
  const bool arrived = drive.run_until(
      [&] {
        drivable = drivable && geometry::drivable(drive.command, radius_m - 1e-6) == drive.command;
        return drive.status().state == NavigatorState::kArrived;
      },
      400.0);
  EXPECT_TRUE(drivable);
  return arrived;
}

TEST(SteeredDrive, ArrivesThroughNarrowDoorsWithoutAContact) {
  const world::World floor = world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/floor.world.yaml");
  for (const std::uint64_t seed : {1U, 2U}) {
    const OutlineTask task = draw_outline_task(floor, seed, kCar);
    TestDrive drive(floor, settings_of(task));
    drive.go_to(task.T_goal.position_m(), task.T_goal.theta_rad);
    EXPECT_TRUE(arrives(drive, kCar.radius_m))
        << "drive " << seed << ": " << drive.status().message;
    EXPECT_EQ(drive.robot.collisions(), 0U) << "drive " << seed;
    EXPECT_LT(drive.off_m(), 0.1) << "drive " << seed;
    EXPECT_LT(std::fabs(geometry::wrap_angle(drive.robot.T_world_robot().theta_rad -
                                             task.T_goal.theta_rad)),
              0.1)
        << "drive " << seed;
  }
}

TEST(SteeredDrive, ARoundBodyKeepsTheRadiusToo) {
  DriveSettings settings;
  settings.T_world_start = {1.5, 3.0, 3.0};
  settings.navigator.guard.minimum_turning_radius_m = 0.8;
  TestDrive drive(two_doors(), settings);
  drive.go_to({8.0, 3.0}, -1.5);
  EXPECT_TRUE(arrives(drive, 0.8)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_LT(drive.off_m(), 0.1);
  EXPECT_NEAR(drive.robot.T_world_robot().theta_rad, -1.5, 0.1);
}

TEST(SteeredDrive, StandsWithAReasonWhereOnlyATurnOnTheSpotLeads) {
  // A closed booth in which the rectangle has room to turn and none to drive.
  const world::World booth = world::parse_world(R"(
name: booth
walls:
  - {from: [0, 0], to: [1.6, 0]}
  - {from: [1.6, 0], to: [1.6, 1.6]}
  - {from: [1.6, 1.6], to: [0, 1.6]}
  - {from: [0, 1.6], to: [0, 0]}
tour: [[0.8, 0.8], [0.9, 0.8]]
)",
                                                "booth");
  OutlineTask task;
  task.T_start = {0.8, 0.8, 0.0};
  task.base = kCar;
  TestDrive drive(booth, settings_of(task));
  drive.go_to({0.8, 0.8}, 1.57);
  EXPECT_TRUE(drive.run_until([&] { return drive.halted(HaltReason::kNoRoute); }, 5.0))
      << drive.status().message;
  EXPECT_NE(drive.status().message.find("cannot turn within 0.80 m"), std::string::npos)
      << drive.status().message;
  EXPECT_EQ(drive.robot.path_m(), 0.0);
}

}  // namespace
}  // namespace topogeo::navigation
