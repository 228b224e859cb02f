// Every reason to stand still: it stops in the same step, reports the reason, and drives on later.
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

using testing::HasSubstr;

class NavigatorHalt : public testing::Test {
 protected:
  static DriveSettings settings() {
    DriveSettings settings;
    settings.T_world_start = {1.0, 1.0, 0.0};
    settings.navigator.guard.needs_sonar = true;
    return settings;
  }

  void drive_off() {
    drive.go_to({6.5, 4.5});
    ASSERT_TRUE(drive.run_until([&] { return drive.command.linear_m_per_s > 0.3; }, 10.0))
        << drive.status().message;
    ASSERT_EQ(drive.status().state, NavigatorState::kDriving);
    ASSERT_EQ(drive.status().reason, HaltReason::kNone);
  }

  /// Nothing moves from the first step with that reason on.
  void expect_halt(HaltReason reason, NavigatorState state, double within_s) {
    ASSERT_TRUE(drive.run_until([&] { return drive.halted(reason); }, within_s))
        << drive.status().message;
    EXPECT_EQ(drive.command, geometry::Velocity{});
    EXPECT_EQ(drive.status().state, state);
    EXPECT_FALSE(drive.status().message.empty());
    for (int i = 0; i < 20; ++i) {
      drive.step();
      EXPECT_EQ(drive.command, geometry::Velocity{});
    }
  }

  void expect_arrival() {
    ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
    EXPECT_LT(drive.off_m(), 0.05);
    EXPECT_EQ(drive.robot.collisions(), 0U);
  }

  TestDrive drive{room(), settings()};
};

TEST_F(NavigatorHalt, WithoutGoalItIsIdle) {
  drive.step();
  EXPECT_EQ(drive.status().state, NavigatorState::kIdle);
  EXPECT_EQ(drive.status().reason, HaltReason::kNone);
  EXPECT_EQ(drive.command, geometry::Velocity{});
}

TEST_F(NavigatorHalt, WaitsForTheRoute) {
  drive.planner_answers = false;
  drive.go_to({6.5, 4.5});
  expect_halt(HaltReason::kWaitsForRoute, NavigatorState::kStopped, 0.1);
  EXPECT_FALSE(drive.run_until([&] { return drive.command != geometry::Velocity{}; }, 10.0));
  EXPECT_THAT(drive.status().message, HasSubstr("not answered"));
  drive.planner_answers = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, ReportsWhyThereIsNoRoute) {
  drive.go_to({20.0, 4.5});
  expect_halt(HaltReason::kNoRoute, NavigatorState::kStopped, 0.2);
  EXPECT_THAT(drive.status().message, HasSubstr("outside"));
  drive.go_to({6.5, 4.5});
  expect_arrival();
}

TEST_F(NavigatorHalt, RoutesOfOtherGoalsAreIgnored) {
  drive.planner_answers = false;
  drive.go_to({6.5, 4.5});
  RoutePlan route;
  route.goal_id = drive.goal_id + 1;
  route.map_version = drive.map_version;
  route.found = true;
  route.points_m = {{1.0, 1.0}, {3.0, 1.0}};
  drive.navigator.set_route(route);
  expect_halt(HaltReason::kWaitsForRoute, NavigatorState::kStopped, 0.1);
}

TEST_F(NavigatorHalt, ARouteOfAMapToComeWaitsForIt) {
  drive.go_to({6.5, 4.5});
  drive.map_version = 2;  // the planner already has it
  expect_halt(HaltReason::kWaitsForRoute, NavigatorState::kStopped, 0.1);
  drive.navigator.set_map(drive.map, 2);
  expect_arrival();
}

TEST_F(NavigatorHalt, ARouteOfAnOlderMapIsGoodWhereItHasRoom) {
  drive.go_to({6.5, 4.5});
  drive.send_route();
  drive.navigator.set_map(drive.map, 2);
  drive.planner_answers = false;
  expect_arrival();
}

TEST_F(NavigatorHalt, ARouteOfAnOlderMapThatIsNoMoreFreeIsNone) {
  drive.go_to({6.5, 4.5});
  drive.send_route();
  drive.planner_answers = false;
  world::World walled = drive.world;
  walled.segments.push_back({{4.0, 0.0}, {4.0, 5.0}});
  drive.navigator.set_map(map_of(walled), 2);
  expect_halt(HaltReason::kWaitsForRoute, NavigatorState::kStopped, 0.1);
}

TEST_F(NavigatorHalt, TheSameRouteAgainChangesNothing) {
  drive_off();
  for (int i = 0; i < 40; ++i) {
    drive.send_route();
    drive.step();
    EXPECT_GT(drive.command.linear_m_per_s, 0.3);
  }
  EXPECT_EQ(drive.status().routes, 1U);
  expect_arrival();
}

TEST_F(NavigatorHalt, Cancelled) {
  drive_off();
  drive.navigator.cancel();
  drive.step();
  EXPECT_EQ(drive.command, geometry::Velocity{});
  expect_halt(HaltReason::kCancelled, NavigatorState::kIdle, 0.1);
  drive.go_to({6.5, 4.5});
  expect_arrival();
}

TEST_F(NavigatorHalt, PausedAndResumed) {
  drive_off();
  drive.navigator.pause();
  drive.step();
  EXPECT_EQ(drive.command, geometry::Velocity{});
  expect_halt(HaltReason::kPaused, NavigatorState::kStopped, 0.1);
  drive.navigator.resume();
  expect_arrival();
}

TEST_F(NavigatorHalt, APauseAtTheGoalIsReported) {
  drive_off();
  expect_arrival();
  EXPECT_EQ(drive.status().reason, HaltReason::kNone);
  drive.navigator.pause();
  drive.step();
  EXPECT_EQ(drive.status().state, NavigatorState::kArrived);
  EXPECT_EQ(drive.status().reason, HaltReason::kPaused);
  drive.navigator.resume();
  drive.step();
  EXPECT_EQ(drive.status().state, NavigatorState::kArrived);
  EXPECT_EQ(drive.status().reason, HaltReason::kNone);
}

// The navigator service replaces the navigator when the odometry restarts.
TEST_F(NavigatorHalt, AnArrivalAndItsPauseOutliveTheNavigator) {
  Navigator next(settings().navigator);
  next.stay_arrived("arrived");
  next.step(drive.now_ns);
  EXPECT_EQ(next.status().state, NavigatorState::kIdle) << "it has no goal";
  next.set_goal({7, false});
  next.stay_arrived("arrived");
  next.pause();
  EXPECT_EQ(next.step(drive.now_ns), geometry::Velocity{});
  EXPECT_EQ(next.status().state, NavigatorState::kArrived);
  EXPECT_EQ(next.status().reason, HaltReason::kPaused);
  EXPECT_EQ(next.status().goal_id, 7U);
  EXPECT_EQ(next.status().message, "arrived");
  next.resume();
  next.step(drive.now_ns);
  EXPECT_EQ(next.status().state, NavigatorState::kArrived);
  EXPECT_EQ(next.status().reason, HaltReason::kNone);
}

TEST_F(NavigatorHalt, PoseLostIsZeroInTheSameStep) {
  drive_off();
  drive.tracking = false;
  // Poses come every fourth step; the step that receives the lost one commands exactly zero.
  while (drive.status().reason == HaltReason::kNone) drive.step();
  EXPECT_EQ(drive.command, geometry::Velocity{});
  EXPECT_FALSE(drive.status().T_map_robot);
  expect_halt(HaltReason::kPoseLost, NavigatorState::kRelocalizing, 0.1);
  EXPECT_THAT(drive.status().message, HasSubstr("searching"));
  drive.tracking = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, PoseTooOld) {
  drive_off();
  drive.poses_come = false;
  expect_halt(HaltReason::kPoseLost, NavigatorState::kRelocalizing, 3.5);
  drive.poses_come = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, PoseTooUncertain) {
  drive_off();
  drive.sigma_m = 0.6;
  expect_halt(HaltReason::kPoseLost, NavigatorState::kRelocalizing, 0.5);
  EXPECT_THAT(drive.status().message, HasSubstr("0.60 m"));
  drive.sigma_m = 0.02;
  expect_arrival();
}

TEST_F(NavigatorHalt, NoMap) {
  drive_off();
  drive.navigator.set_map(nullptr, 2);
  expect_halt(HaltReason::kNoMap, NavigatorState::kStopped, 0.1);
  drive.map_version = 3;
  drive.navigator.set_map(drive.map, 3);
  expect_arrival();
}

TEST_F(NavigatorHalt, NoScan) {
  drive_off();
  drive.scans_come = false;
  expect_halt(HaltReason::kNoScan, NavigatorState::kStopped, 1.0);
  drive.scans_come = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, SonarsDoNotCome) {
  drive_off();
  drive.sonars_come = false;
  expect_halt(HaltReason::kSonarSilent, NavigatorState::kStopped, 1.5);
  drive.sonars_come = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, SonarsHearNothing) {
  drive_off();
  drive.sonars_hear = false;
  expect_halt(HaltReason::kSonarSilent, NavigatorState::kStopped, 20.0);
  EXPECT_THAT(drive.status().message, HasSubstr("no sonar echo"));
  drive.sonars_hear = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, NoOdometry) {
  drive_off();
  drive.odometry_comes = false;
  expect_halt(HaltReason::kNoOdometry, NavigatorState::kStopped, 1.5);
  drive.odometry_comes = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, BaseNotReadyDrivesOnByItself) {
  drive_off();
  drive.base_ready = false;
  expect_halt(HaltReason::kBaseNotReady, NavigatorState::kStopped, 0.1);
  EXPECT_THAT(drive.status().message, HasSubstr("emergency stop"));
  drive.base_ready = true;
  expect_arrival();
}

// A base of ROS reports no stop, so the navigator itself holds the robot.
TEST_F(NavigatorHalt, AnOperatorsStopHoldsOverResumesAndGoals) {
  drive_off();
  drive.navigator.set_stopped("stopped by an operator");
  expect_halt(HaltReason::kBaseNotReady, NavigatorState::kStopped, 0.1);
  EXPECT_THAT(drive.status().message, HasSubstr("stopped by an operator"));
  drive.navigator.resume();
  expect_halt(HaltReason::kBaseNotReady, NavigatorState::kStopped, 0.1);
  drive.go_to({6.5, 4.5});
  expect_halt(HaltReason::kBaseNotReady, NavigatorState::kStopped, 0.1);
  drive.navigator.set_stopped({});
  expect_arrival();
}

TEST_F(NavigatorHalt, BaseThatDoesNotMoveStaysStoppedUntilResumed) {
  drive_off();
  drive.base_obeys = false;
  expect_halt(HaltReason::kBaseStuck, NavigatorState::kStopped, 4.0);
  drive.base_obeys = true;
  EXPECT_FALSE(drive.run_until([&] { return drive.command != geometry::Velocity{}; }, 5.0));
  drive.navigator.resume();
  expect_arrival();
}

TEST_F(NavigatorHalt, BaseThatWasStuckInAnEarlierLifeStaysStoppedUntilResumed) {
  drive.go_to({6.5, 4.5});
  drive.navigator.stay_stuck();
  EXPECT_TRUE(drive.navigator.is_stuck());
  EXPECT_FALSE(drive.run_until([&] { return drive.command != geometry::Velocity{}; }, 5.0));
  EXPECT_EQ(drive.status().reason, HaltReason::kBaseStuck);
  drive.navigator.resume();
  expect_arrival();
}

TEST_F(NavigatorHalt, OutsideOfTheMap) {
  drive.go_to({6.5, 4.5});
  drive.robot.carry({30.0, 30.0, 0.0});
  expect_halt(HaltReason::kOutsideMap, NavigatorState::kStopped, 0.5);
  EXPECT_THAT(drive.status().message, HasSubstr("30.00, 30.00"));
  drive.robot.carry({1.0, 1.0, 0.0});
  drive.send_route();
  expect_arrival();
}

TEST_F(NavigatorHalt, CarriedAwayItWaitsForARouteFromThere) {
  drive_off();
  drive.robot.carry({1.5, 5.0, 0.0});
  drive.planner_answers = false;
  expect_halt(HaltReason::kWaitsForRoute, NavigatorState::kRelocalizing, 0.5);
  drive.send_route();
  expect_arrival();
}

TEST_F(NavigatorHalt, AMapWithRoomForTheRouteDoesNotStopIt) {
  drive_off();
  drive.map_version = 2;
  drive.planner_answers = false;
  drive.navigator.set_map(drive.map, 2);
  drive.step();
  EXPECT_GT(drive.command.linear_m_per_s, 0.2);
  expect_arrival();
}

TEST_F(NavigatorHalt, AMapWithAWallAcrossTheRouteStopsIt) {
  drive_off();
  drive.planner_answers = false;
  world::World walled = drive.world;
  walled.segments.push_back({{4.0, 0.0}, {4.0, 5.0}});
  drive.map = map_of(walled);
  drive.map_version = 2;
  drive.navigator.set_map(drive.map, 2);
  expect_halt(HaltReason::kWaitsForRoute, NavigatorState::kStopped, 0.1);
  drive.planner_answers = true;
  expect_arrival();
}

TEST_F(NavigatorHalt, LooksAroundWhereItMay) {
  drive.look_around = true;
  drive.tracking = false;
  drive.go_to({6.5, 4.5});
  double turned_rad = 0.0;
  double gone_m = 0.0;
  geometry::Pose2 before = drive.robot.T_world_robot();
  drive.run_until(
      [&] {
        const geometry::Pose2 step = between(before, drive.robot.T_world_robot());
        before = drive.robot.T_world_robot();
        turned_rad += std::abs(step.theta_rad);
        gone_m += step.position_m().norm();
        return false;
      },
      180.0);
  EXPECT_EQ(drive.status().state, NavigatorState::kRelocalizing);
  EXPECT_THAT(drive.status().message, HasSubstr("without finding the pose"));
  EXPECT_GT(turned_rad, 30.0);
  EXPECT_GT(gone_m, 3.0);
  EXPECT_LT(gone_m, 5.2);
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_EQ(drive.command, geometry::Velocity{});
  drive.tracking = true;
  expect_arrival();
}

}  // namespace
}  // namespace topogeo::navigation
