#include "topogeo/navigation/markov_tracker.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/scan/scan.hpp"

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

MarkovTrackerConfig positions() {
  MarkovTrackerConfig config;
  config.grid = MarkovGrid::kPositions;
  return config;
}

/// A robot without noise in two rooms, with odometry that is 3 % short.
class MarkovDrive : public testing::Test {
 protected:
  MarkovDrive() {
    simulation::RobotOptions options;
    options.T_world_start = geometry::Pose2{1.25, 1.55, 0.0};
    options.laser = {0.0, 0.0, 0.0, 0.0};
    options.sonar.sigma_m = 0.0;
    options.odometry = {-0.03, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    robot.emplace(world, options);
  }

  SonarRound sonars() {
    SonarRound round;
    const std::vector<float> ranges_m = robot->sonar();
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const auto& mount = robot->options().sonars[i];
      round.readings.push_back({mount.T_robot_sonar, mount.half_cone_rad, ranges_m[i]});
    }
    return round;
  }

  void drive(double distance_m, double turn_rad) {
    robot->step({distance_m, turn_rad}, 1.0);
    tracker.add(OdometrySample{++stamp_ns, robot->T_odom_robot()});
  }

  [[nodiscard]] double off_m() const {
    return (tracker.fix()->T_map_robot.position_m() - robot->T_world_robot().position_m()).norm();
  }

  world::World world = two_doors();
  std::optional<simulation::SimulatedRobot> robot;
  MarkovTracker tracker{map_of(world)->space().grid(), positions()};
  std::int64_t stamp_ns = 0;
};

TEST_F(MarkovDrive, StartsAtTheBaseStation) {
  EXPECT_FALSE(tracker.started());
  EXPECT_FALSE(tracker.fix());
  tracker.add(OdometrySample{++stamp_ns, robot->T_odom_robot()});
  ASSERT_TRUE(tracker.start({1.25, 1.55, 0.0}, sonars()));
  ASSERT_TRUE(tracker.fix());
  EXPECT_TRUE(tracker.fix()->tracking);
  EXPECT_LT(off_m(), 0.02);
}

TEST_F(MarkovDrive, AStationInAWallIsRefusedWithTheReason) {
  EXPECT_FALSE(tracker.start({5.0, 3.0, 0.0}, sonars()));
  EXPECT_FALSE(tracker.reason().empty());
  EXPECT_FALSE(tracker.started());
  EXPECT_FALSE(tracker.fix());
}

TEST_F(MarkovDrive, LookingPutsRightWhatOdometryGetsWrong) {
  tracker.add(OdometrySample{++stamp_ns, robot->T_odom_robot()});
  ASSERT_TRUE(tracker.start({1.25, 1.55, 0.0}, sonars()));
  for (int i = 0; i < 6; ++i) {
    drive(1.0, 0.0);
    tracker.primitive_done();
  }
  EXPECT_NEAR(off_m(), 0.18, 0.02);  // 3 % of 6 m
  tracker.perceive(sonars());
  EXPECT_TRUE(tracker.fix()->tracking);
  EXPECT_GT(tracker.corrected_m(), 0.05);
  EXPECT_LT(off_m(), 0.1 * std::numbers::sqrt2);  // in its cell or the next one
}

TEST_F(MarkovDrive, TurnsAndArcsAreToldAsPrimitives) {
  tracker.add(OdometrySample{++stamp_ns, robot->T_odom_robot()});
  ASSERT_TRUE(tracker.start({1.25, 1.55, 0.0}, sonars()));
  drive(0.0, 0.5 * std::numbers::pi);
  tracker.primitive_done();
  drive(1.0, 0.3);
  drive(0.5, -0.3);
  tracker.primitive_done();
  const auto fix = tracker.fix();
  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->T_map_robot.theta_rad, 0.5 * std::numbers::pi, 0.03);
  EXPECT_LT(off_m(), 0.12);
  const auto back = tracker.return_moves({1.25, 2.0, 0.0});
  ASSERT_TRUE(back);
  EXPECT_FALSE(back->blocked);
  EXPECT_FALSE(back->moves.empty());
}

TEST_F(MarkovDrive, PerceivingBeforeTheStartIsAMistake) {
  EXPECT_THROW(tracker.perceive(sonars()), std::runtime_error);
}

/// Only the base station is given; the robot finds the goal by itself.
TEST(NavigatorMarkov, DrivesFromTheBaseStationThroughADoor) {
  for (const bool by_laser : {false, true}) {
    DriveSettings settings;
    settings.navigator.markov.grid = MarkovGrid::kPositions;
    settings.T_world_start = {1.25, 4.55, 0.0};
    settings.navigator.motion = MotionStyle::kPrimitives;
    settings.navigator.pose_source = PoseSource::kMarkov;
    settings.navigator.markov_by_laser = by_laser;
    TestDrive drive(two_doors(), settings);
    drive.go_to({8.5, 1.5}, 0.0);
    drive.step();
    drive.poses_come = false;
    int looks = 0;
    bool before = false;
    const bool arrived = drive.run_until(
        [&] {
          const bool looking = drive.status().state == NavigatorState::kRelocalizing;
          if (looking && !before) ++looks;
          if (looking) {
            EXPECT_EQ(drive.command, geometry::Velocity{});
          }
          before = looking;
          return drive.status().state == NavigatorState::kArrived;
        },
        120.0);
    ASSERT_TRUE(arrived) << drive.status().message << (by_laser ? " by laser" : " by sonar");
    EXPECT_GE(looks, 2);  // at the border node and at the end
    EXPECT_LT(drive.off_m(), 0.15);
    EXPECT_EQ(drive.robot.collisions(), 0U);
  }
}

/// Wheels of a recorded log, sonars as bad as published, no laser; readings come while it drives.
TEST(NavigatorMarkov, DrivesThroughADoorBySonarsAlone) {
  DriveSettings settings;
  settings.T_world_start = {1.25, 4.55, 0.0};
  settings.noise = true;
  settings.navigator.motion = MotionStyle::kPrimitives;
  settings.navigator.pose_source = PoseSource::kMarkov;
  settings.navigator.guard.needs_scan = false;
  settings.navigator.guard.needs_sonar = true;
  settings.navigator.follower.speed_m_per_s = 0.3;
  TestDrive drive(two_doors(), settings);
  drive.scans_come = false;
  drive.go_to({8.5, 1.5}, 0.0);
  drive.step();
  drive.poses_come = false;
  ASSERT_TRUE(drive.arrives(180.0)) << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.1);
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

TEST(MarkovTrackerPoses, HearsOnTheWayAndWaitsForOdometry) {
  const world::World world = two_doors();
  simulation::RobotOptions options;
  options.T_world_start = geometry::Pose2{1.25, 1.55, 0.0};
  options.sonar.sigma_m = 0.0;
  options.odometry = {-0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  simulation::SimulatedRobot robot(world, options);
  const auto heard = [&](std::int64_t stamp_ns) {
    SonarRound round;
    round.stamp_ns = stamp_ns;
    const std::vector<float> ranges_m = robot.sonar();
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const auto& mount = robot.options().sonars[i];
      round.readings.push_back({mount.T_robot_sonar, mount.half_cone_rad, ranges_m[i]});
    }
    return round;
  };
  MarkovTracker tracker{map_of(world)->space().grid()};
  std::int64_t now_ns = 1;
  tracker.add(OdometrySample{now_ns, robot.T_odom_robot()});
  ASSERT_TRUE(tracker.start({1.25, 1.55, 0.0}, heard(now_ns)));
  for (int i = 0; i < 60; ++i) {
    robot.step({0.1, 0.0}, 1.0);
    now_ns += 1'000'000;
    tracker.hear(heard(now_ns));  // before their odometry
    tracker.add(OdometrySample{now_ns, robot.T_odom_robot()});
  }
  const auto fix = tracker.fix();
  ASSERT_TRUE(fix);
  EXPECT_TRUE(fix->tracking);
  // Odometry alone is off by 0.3 m now.
  EXPECT_LT((fix->T_map_robot.position_m() - robot.T_world_robot().position_m()).norm(), 0.1);
  EXPECT_FALSE(tracker.return_moves({2.0, 1.5, 0.0}));
}

TEST(NavigatorMarkov, AMapThatComesAgainBeforeTheStartLeavesTheBaseStation) {
  for (const bool station_first : {false, true}) {
    DriveSettings settings;
    settings.T_world_start = {1.25, 4.55, 0.0};
    settings.navigator.pose_source = PoseSource::kMarkov;
    settings.navigator.markov.grid = MarkovGrid::kPositions;
    TestDrive drive(two_doors(), settings);
    drive.poses_come = station_first;
    drive.sonars_come = false;  // so that it does not start yet
    drive.step();
    drive.navigator.set_map(drive.map, ++drive.map_version);
    drive.poses_come = drive.sonars_come = true;
    ASSERT_TRUE(drive.run_until([&] { return drive.status().T_map_robot.has_value(); }, 1.0));
    EXPECT_NEAR(drive.status().T_map_robot->x_m, 1.25, 0.05);
    EXPECT_NEAR(drive.status().T_map_robot->y_m, 4.55, 0.05);
  }
}

/// No pose ever arrives: the base station is a place of the map.
TEST(NavigatorMarkov, StartsAtTheBaseStationOfTheMap) {
  for (const std::string name : {"base station", "dock"}) {
    DriveSettings settings;
    settings.T_world_start = {1.25, 4.55, 0.5};
    settings.navigator.pose_source = PoseSource::kMarkov;
    settings.navigator.markov.station_heading_rad = 0.5;
    settings.navigator.guard.needs_scan = false;
    TestDrive drive(two_doors(), settings);
    drive.poses_come = drive.scans_come = false;
    const std::vector<planning::Place> places{{name, {1.25, 4.55}}};
    drive.navigator.set_map(
        std::make_shared<planning::HybridMap>(drive.map->space(), drive.map->zones(), places),
        drive.map_version);
    const bool started =
        drive.run_until([&] { return drive.status().T_map_robot.has_value(); }, 1.0);
    ASSERT_EQ(started, name == "base station") << name;
    if (!started) continue;
    EXPECT_NEAR(drive.status().T_map_robot->x_m, 1.25, 0.1);
    EXPECT_NEAR(drive.status().T_map_robot->y_m, 4.55, 0.1);
    EXPECT_NEAR(drive.status().T_map_robot->theta_rad, 0.5, 0.1);
    drive.go_to({2.5, 4.55});
    EXPECT_TRUE(drive.arrives(60.0)) << drive.status().message;
  }
}

TEST(LaserRound, HasABeamForEveryStep) {
  ScanPoints scan;
  scan.stamp_ns = 7;
  scan.points_m = {{2.0, 0.0}, {2.0, 0.003}, {0.0, 1.5}, {1.0, 0.3}};
  const SonarRound round = laser_round(scan, 0.25 * std::numbers::pi);
  ASSERT_EQ(round.readings.size(), 5U);
  EXPECT_EQ(round.stamp_ns, 7);
  EXPECT_EQ(round.readings[0].range_m, scan::Scan::kNoReturn);
  EXPECT_FLOAT_EQ(round.readings[2].range_m, 2.0F);
  EXPECT_EQ(round.readings[3].range_m, scan::Scan::kNoReturn);  // a point 17 degrees off its axis
  EXPECT_FLOAT_EQ(round.readings[4].range_m, 1.5F);
  EXPECT_NEAR(round.readings[4].T_robot_sonar.theta_rad, 0.5 * std::numbers::pi, 1e-12);
  EXPECT_THROW(laser_round(scan, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::navigation
