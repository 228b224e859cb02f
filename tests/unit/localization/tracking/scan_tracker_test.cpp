#include "topogeo/matching/scan_tracker.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

// A drive of 1.6 m along the south corridor past a junction, with odometry that measures 8 % too
// much and drifts 3 degrees per metre to the left.
class ScanTrackerTest : public testing::Test {
 protected:
  ScanTrackerTest() : floor_(test::world("floor")) {
    for (int i = 0; i <= 8; ++i) T_stop_robot_.push_back({0.2 * i, 0.01 * i, 0.03 * i});
    T_odom_.push_back({3.0, 4.0, 1.0});
    for (std::size_t i = 1; i < T_stop_robot_.size(); ++i) {
      Pose2 step = geometry::between(T_stop_robot_[i - 1], T_stop_robot_[i]);
      step.x_m *= 1.08;
      step.theta_rad += 0.2 * 3.0 * kDegree;
      T_odom_.push_back(T_odom_.back() * step);
    }
    tracker_.start(points(0), {}, T_odom_[0]);
  }

  std::vector<topomap::ScanPoint> points(std::size_t i) const {
    return test::map_at(floor_, kStart * T_stop_robot_[i], static_cast<std::uint32_t>(i)).points;
  }
  Pose2 odometry(std::size_t i) const { return geometry::between(T_odom_[0], T_odom_[i]); }

  static constexpr Pose2 kStart{8.0, 1.2, 0.1};
  world::World floor_;
  std::vector<Pose2> T_stop_robot_;  // truth
  std::vector<Pose2> T_odom_;
  ScanTracker tracker_{{}};
};

TEST_F(ScanTrackerTest, FollowsTheTruthWhileOdometryDrifts) {
  for (std::size_t i = 1; i < T_odom_.size(); ++i) {
    const TrackedPose pose = tracker_.track(points(i), T_odom_[i]);
    EXPECT_TRUE(pose.matched) << i;
    EXPECT_LT(test::distance_m(pose.T_stop_robot, T_stop_robot_[i]), 0.03) << i;
    EXPECT_LT(test::turn_rad(pose.T_stop_robot, T_stop_robot_[i]), 0.6 * kDegree) << i;
  }
  EXPECT_GT(test::distance_m(odometry(8), T_stop_robot_[8]), 0.12);
  EXPECT_GT(test::turn_rad(odometry(8), T_stop_robot_[8]), 4.0 * kDegree);
}

TEST_F(ScanTrackerTest, AStandingRobotStaysWhereItIs) {
  for (int i = 0; i < 5; ++i) {
    const TrackedPose pose = tracker_.track(points(0), T_odom_[0]);
    EXPECT_TRUE(pose.matched);
    EXPECT_LT(test::distance_m(pose.T_stop_robot, {}), 0.005);
  }
}

TEST_F(ScanTrackerTest, ABlindScanIsPlacedByOdometryAloneAndTheNextOneMatchesAgain) {
  tracker_.track(points(1), T_odom_[1]);
  const Pose2 before = tracker_.track(points(2), T_odom_[2]).T_stop_robot;
  const TrackedPose blind = tracker_.track({}, T_odom_[3]);
  EXPECT_FALSE(blind.matched);
  const Pose2 by_odometry = before * geometry::between(T_odom_[2], T_odom_[3]);
  EXPECT_LT(test::distance_m(blind.T_stop_robot, by_odometry), 1e-9);
  const TrackedPose next = tracker_.track(points(4), T_odom_[4]);
  EXPECT_TRUE(next.matched);
  EXPECT_LT(test::distance_m(next.T_stop_robot, T_stop_robot_[4]), 0.03);
}

TEST_F(ScanTrackerTest, AScanOfAnotherPlaceDoesNotMatch) {
  const auto elsewhere = test::map_at(test::world("room"), {3.0, 0.8, 0.4}, 1).points;
  const TrackedPose pose = tracker_.track(elsewhere, T_odom_[1]);
  EXPECT_FALSE(pose.matched);
  EXPECT_LT(test::distance_m(pose.T_stop_robot, odometry(1)), 1e-9);
}

TEST_F(ScanTrackerTest, WheelsThatSpinMoveNothing) {
  const world::World room = test::world("room");
  constexpr Pose2 kPlace{3.0, 0.8, 0.4};
  std::uint32_t scan = 0;
  const auto points_at = [&](const Pose2& T) {
    return test::map_at(room, kPlace * T, ++scan).points;
  };
  tracker_.start(points_at({}), {}, {});
  Pose2 T_odom_robot;
  for (int i = 0; i < 5; ++i) {
    T_odom_robot = T_odom_robot * Pose2{0.4, 0.0, 0.0};
    const TrackedPose pose = tracker_.track(points_at({}), T_odom_robot);
    EXPECT_TRUE(pose.matched) << i;
    EXPECT_LT(test::distance_m(pose.T_stop_robot, {}), 0.03) << i;
  }
  const Pose2 T_stop_robot{0.2, 0.0, 0.0};
  const TrackedPose next = tracker_.track(points_at(T_stop_robot), T_odom_robot * T_stop_robot);
  EXPECT_TRUE(next.matched);
  EXPECT_LT(test::distance_m(next.T_stop_robot, T_stop_robot), 0.03) << "the wheels roll again";
}

TEST_F(ScanTrackerTest, ARobotThatIsCarriedIsFollowedByItsScans) {
  for (std::size_t i = 1; i <= 5; ++i) {
    const TrackedPose pose = tracker_.track(points(i), T_odom_[0]);
    EXPECT_TRUE(pose.matched) << i;
    EXPECT_LT(test::distance_m(pose.T_stop_robot, T_stop_robot_[i]), 0.05) << i;
  }
}

TEST_F(ScanTrackerTest, StartsAgainAtEachStop) {
  for (std::size_t i = 1; i <= 4; ++i) tracker_.track(points(i), T_odom_[i]);
  tracker_.start(points(4), {}, T_odom_[4]);
  const TrackedPose pose = tracker_.track(points(6), T_odom_[6]);
  EXPECT_TRUE(pose.matched);
  EXPECT_LT(
      test::distance_m(pose.T_stop_robot, geometry::between(T_stop_robot_[4], T_stop_robot_[6])),
      0.03);
}

// A corridor of two bare walls. Both ends are out of the range of its laser, so only odometry knows
// the distance along it. 5.6 m is the range of a small laser.
class BareCorridor : public testing::TestWithParam<int> {
 protected:
  BareCorridor() {
    corridor_.segments = {{{-30.0, -0.9}, {30.0, -0.9}}, {{-30.0, 1.1}, {30.0, 1.1}}};
  }

  std::vector<topomap::ScanPoint> points(const Pose2& T_world_robot) {
    constexpr simulation::BeamPattern kBeams{-2.0, 4.0 / 725.0, 726, 5.6};
    scan::Scan scan;
    scan.angle_min_rad = kBeams.angle_min_rad;
    scan.angle_step_rad = kBeams.angle_step_rad;
    scan.ranges_m =
        simulation::measure(simulation::raycast(corridor_, T_world_robot, kBeams), {}, random_);
    return topomap::scan_points(scan, {}, 20.0);
  }

  world::World corridor_;
  support::Random random_{static_cast<std::uint64_t>(GetParam())};
};

TEST_P(BareCorridor, IsFollowedByOdometry) {
  constexpr double kStep_m = 0.02;
  ScanTracker tracker{{}};
  tracker.start(points({}), {}, {});
  for (int i = 1; i <= 60; ++i) {
    const Pose2 T{kStep_m * i, 0.0, 0.02};
    const TrackedPose pose = tracker.track(points(T), {kStep_m * i, 0.0, 0.0});
    EXPECT_TRUE(pose.matched) << i;
    EXPECT_NEAR(pose.T_stop_robot.x_m, T.x_m, 0.1) << i;
    EXPECT_NEAR(pose.T_stop_robot.y_m, T.y_m, 0.03) << i;
    EXPECT_NEAR(pose.T_stop_robot.theta_rad, T.theta_rad, 0.02) << i;
    EXPECT_DOUBLE_EQ(pose.T_stop_odometry.x_m, kStep_m * i) << i;
  }
}

// No scan contradicts the wheels there.
TEST_P(BareCorridor, LetsTheWheelsDecideAlongIt) {
  ScanTracker tracker{{}};
  tracker.start(points({}), {}, {});
  for (int i = 1; i <= 4; ++i) {
    const Pose2 T_odom_robot{0.4 * i, 0.0, 0.0};
    const TrackedPose pose = tracker.track(points(T_odom_robot), T_odom_robot);
    EXPECT_FALSE(pose.against_odometry) << i;
    EXPECT_NEAR(pose.T_stop_robot.x_m, T_odom_robot.x_m, 0.15) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, BareCorridor, testing::Range(1, 6));

TEST(ScanTrackerStartTest, WithoutAStopThereIsOnlyOdometry) {
  ScanTracker tracker{{}};
  const auto points = test::exact_points(test::l_room(), {});
  const TrackedPose pose = tracker.track(points, {0.5, 0.0, 0.0});
  EXPECT_FALSE(pose.matched);
  EXPECT_LT(test::distance_m(pose.T_stop_robot, {0.5, 0.0, 0.0}), 1e-9);
}

}  // namespace
}  // namespace topogeo::localization
