// Unmapped obstacles: avoided, waited for, reported.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

using testing::HasSubstr;

DriveSettings starting_from(double x_m, double y_m, double heading_rad) {
  DriveSettings settings;
  settings.T_world_start = {x_m, y_m, heading_rad};
  settings.navigator.detour.half_side_m = 2.0;  // the other door is out of view
  return settings;
}

world::ChangingPart box(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m, double from_s,
                        double to_s) {
  world::ChangingPart part;
  const Eigen::Vector2d right_m(high_m.x(), low_m.y());
  const Eigen::Vector2d left_m(low_m.x(), high_m.y());
  part.segments = {{low_m, right_m}, {right_m, high_m}, {high_m, left_m}, {left_m, low_m}};
  part.present_s = {{from_s, to_s}};
  return part;
}

constexpr double kEver_s = 1e6;

TEST(NavigatorObstacle, ABoxInTheRoomIsGoneRound) {
  world::World world = room();
  world.changing.push_back(box({3.5, 2.0}, {4.3, 3.0}, 0.0, kEver_s));
  TestDrive drive(world, starting_from(1.0, 2.5, 0.0));
  drive.go_to({7.0, 2.5});
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.05);
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_GE(drive.status().detours, 1U);
  EXPECT_LE(drive.status().detours, 4U);
  EXPECT_EQ(drive.navigator.blockages().version, 0U);
  EXPECT_GT(drive.shortest_clearance_m, 0.28);
}

TEST(NavigatorObstacle, ADoorThatIsShutForAWhileIsWaitedFor) {
  world::World world = two_doors();
  world.changing.push_back(box({4.95, 0.5}, {5.05, 2.5}, 0.0, 7.5));
  TestDrive drive(world, starting_from(2.0, 1.5, 0.0));
  drive.go_to({8.5, 1.5});
  ASSERT_TRUE(
      drive.run_until([&] { return drive.status().state == NavigatorState::kBlocked; }, 20.0));
  EXPECT_EQ(drive.status().reason, HaltReason::kObstacle);
  EXPECT_THAT(drive.status().message, HasSubstr("in the way"));
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_EQ(drive.navigator.blockages().version, 0U);
}

TEST(NavigatorObstacle, ADoorThatStaysShutIsReportedAndAnotherRouteTaken) {
  world::World world = two_doors();
  world.changing.push_back(box({4.95, 0.5}, {5.05, 2.5}, 0.0, kEver_s));
  TestDrive drive(world, starting_from(2.0, 1.5, 0.0));
  drive.go_to({8.5, 1.5});
  ASSERT_TRUE(drive.arrives(120.0)) << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.05);
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_GE(drive.status().routes, 2U);
  EXPECT_LE(drive.status().routes, 4U);
}

TEST(NavigatorObstacle, WithoutAnotherRouteItStaysBlockedUntilTheDoorOpens) {
  world::World world = two_doors();
  world.changing.push_back(box({4.95, 0.5}, {5.05, 2.5}, 0.0, 60.0));
  world.changing.push_back(box({4.95, 3.5}, {5.05, 5.5}, 0.0, kEver_s));
  TestDrive drive(world, starting_from(2.0, 1.5, 0.0));
  drive.go_to({8.5, 1.5});
  ASSERT_TRUE(drive.run_until([&] { return drive.halted(HaltReason::kNoRoute); }, 60.0))
      << drive.status().message;
  EXPECT_EQ(drive.status().state, NavigatorState::kBlocked);
  EXPECT_EQ(drive.command, geometry::Velocity{});
  EXPECT_FALSE(drive.navigator.blockages().points_m.empty());
  ASSERT_TRUE(drive.arrives(300.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

TEST(NavigatorObstacle, APersonWhoWalksAcrossIsLetPass) {
  world::World world = room();
  world::Person person;
  person.path_m = {{4.0, 0.4}, {4.0, 5.6}};
  person.speed_m_per_s = 0.8;
  person.yields = true;
  world.people.push_back(person);
  TestDrive drive(world, starting_from(1.0, 2.5, 0.0));
  drive.go_to({7.0, 2.5});
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_LE(drive.status().detours, 2U);
  EXPECT_EQ(drive.navigator.blockages().version, 0U);
  EXPECT_LT(drive.status().driven_m, 7.5);
}

TEST(NavigatorObstacle, APersonWhoStepsInFrontOfItStopsIt) {
  world::World world = room();
  world::ChangingPart person;
  person.circles = {{{3.6, 2.5}, 0.25}};
  person.present_s = {{3.2, 8.0}};
  world.changing.push_back(person);
  TestDrive drive(world, starting_from(1.0, 2.5, 0.0));
  drive.go_to({7.0, 2.5});
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

TEST(NavigatorObstacle, WhatOnlySonarsHearStopsItAndIsGoneRound) {
  world::World world = room();
  world::ChangingPart glass;
  glass.circles = {{{4.0, 2.6}, 0.3}};
  glass.present_s = {{0.0, kEver_s}};
  world.changing.push_back(glass);
  TestDrive drive(world, starting_from(1.0, 2.5, 0.0));
  drive.glass = glass.circles.front();
  drive.go_to({7.0, 2.5});
  ASSERT_TRUE(drive.arrives(120.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_GE(drive.status().guard_stops, 1U);
  EXPECT_GE(drive.status().detours, 1U);
}

/// The place of a contact is meaningless after a wrong pose, or on another map.
TEST(NavigatorObstacle, WhatTheGuardMetIsForgottenWithThePoseAndTheMap) {
  enum class Change { kMap, kJump, kLost };
  for (const Change change : {Change::kMap, Change::kJump, Change::kLost}) {
    world::World world = room();
    world::ChangingPart glass;
    glass.circles = {{{4.0, 2.6}, 0.3}};
    glass.present_s = {{0.0, kEver_s}};
    world.changing.push_back(glass);
    TestDrive drive(world, starting_from(1.0, 2.5, 0.0));
    drive.glass = glass.circles.front();
    drive.go_to({7.0, 2.5});
    ASSERT_TRUE(drive.run_until([&] { return drive.status().guard_stops > 0; }, 20.0));
    drive.navigator.pause();
    drive.sonars_hear = false;  // as if the glass were gone
    for (int i = 0; i < 20; ++i) drive.step();
    if (change == Change::kMap) drive.navigator.set_map(drive.map, ++drive.map_version);
    if (change == Change::kJump) {
      drive.robot.carry(drive.robot.T_world_robot() * geometry::Pose2{-0.3, 0.0, 0.0});
    }
    drive.tracking = change != Change::kLost;
    for (int i = 0; i < 5; ++i) drive.step();
    drive.navigator.resume();
    drive.step();
    drive.tracking = true;
    ASSERT_TRUE(drive.run_until([&] { return drive.command.linear_m_per_s > 0.1; }, 3.0))
        << drive.status().message;
    EXPECT_EQ(drive.status().detours, 0U) << static_cast<int>(change);
  }
}

TEST(NavigatorObstacle, AGoalThatIsFilledIsRefusedInTheEnd) {
  world::World world = room();
  world.changing.push_back(box({6.5, 2.4}, {7.1, 3.0}, 0.0, kEver_s));
  TestDrive drive(world, starting_from(1.0, 2.5, 0.0));
  drive.go_to({6.8, 2.7});
  ASSERT_TRUE(drive.run_until([&] { return drive.halted(HaltReason::kNoRoute); }, 60.0))
      << drive.status().message;
  EXPECT_EQ(drive.status().state, NavigatorState::kBlocked);
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

}  // namespace
}  // namespace topogeo::navigation
