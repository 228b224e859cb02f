#include "ros_bridge/laser_scan.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros_messages.hpp"

namespace topogeo::ros_bridge {
namespace {

using testing::ElementsAre;

constexpr double kStraight_rad = std::numbers::pi;

TEST(LaserScan, KeepsTheBeamsOfACounterClockwiseScanner) {
  const Sweep sweep = to_sweep(laser_scan(-0.5, 0.25, {1.0F, 2.0F, 3.0F}), false);
  EXPECT_NEAR(sweep.pattern.angle_min_rad, -0.5, 1e-6);
  EXPECT_NEAR(sweep.pattern.angle_step_rad, 0.25, 1e-6);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(1.0F, 2.0F, 3.0F));
}

TEST(LaserScan, TurnsAClockwiseScannerRound) {
  const Sweep sweep = to_sweep(laser_scan(0.5, -0.25, {1.0F, 2.0F, 3.0F, 4.0F}), false);
  EXPECT_NEAR(sweep.pattern.angle_min_rad, -0.25, 1e-6);
  EXPECT_GT(sweep.pattern.angle_step_rad, 0.0);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(4.0F, 3.0F, 2.0F, 1.0F));
}

// Seen from above what is left of a scanner upside down is on its right.
TEST(LaserScan, MirrorsAScannerUpsideDown) {
  const Sweep sweep = to_sweep(laser_scan(-0.1, 0.25, {1.0F, 2.0F, 3.0F}), true);
  EXPECT_NEAR(sweep.pattern.angle_min_rad, -0.4, 1e-6);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(3.0F, 2.0F, 1.0F));
}

TEST(LaserScan, WhatIsNoEchoIsNone) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const Sweep sweep =
      to_sweep(laser_scan(0.0, 0.1, {none, infinite, -infinite, 0.05F, 30.5F, 0.0F, 29.0F}), false);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 29.0F));
}

TEST(LaserScan, RefusesWhatHasNoBeams) {
  EXPECT_THROW(to_sweep(laser_scan(0.0, 0.1, {}), false), std::invalid_argument);
  EXPECT_THROW(to_sweep(laser_scan(0.0, 0.0, {1.0F, 1.0F}), false), std::invalid_argument);
  EXPECT_THROW(to_sweep(laser_scan(NAN, 0.1, {1.0F, 1.0F}), false), std::invalid_argument);
  EXPECT_THROW(to_sweep(laser_scan(0.0, 4.0, {1.0F, 1.0F, 1.0F}), false), std::invalid_argument);
  ros::LaserScan scan = laser_scan(0.0, 0.1, {1.0F, 1.0F});
  scan.time_increment_(-1.0F);
  EXPECT_THROW(to_sweep(scan, false), std::invalid_argument);
}

TEST(LaserScan, ThinsOutToWhatAMessageTakes) {
  const Sweep sweep =
      thinned(to_sweep(laser_scan(0.0, 0.1, {1.0F, 2.0F, 3.0F, 4.0F, 5.0F}), false), 3);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(1.0F, 3.0F, 5.0F));
  EXPECT_NEAR(sweep.pattern.angle_step_rad, 0.2, 1e-6);
}

TEST(LaserScan, PutsOtherNumbersOfBeamsOnOnePattern) {
  const Sweep sweep = to_sweep(laser_scan(0.01, 0.1, {1.0F, 2.0F, 3.0F}), false);
  EXPECT_THAT(on_pattern(sweep, {-0.1, 0.1, 5}), ElementsAre(0.0F, 1.0F, 2.0F, 3.0F, 0.0F));
}

/// A robot in a square room of 6 m that turns and drives during a sweep: the range of a ray from a
/// pose to the walls.
double to_wall_m(const geometry::Pose2& pose, double angle_rad) {
  const double heading = pose.theta_rad + angle_rad;
  const double x = std::cos(heading);
  const double y = std::sin(heading);
  const double along_x = x > 0.0 ? (3.0 - pose.x_m) / x : (-3.0 - pose.x_m) / x;
  const double along_y = y > 0.0 ? (3.0 - pose.y_m) / y : (-3.0 - pose.y_m) / y;
  return std::min(along_x, along_y);
}

TEST(LaserScan, TakesTheMotionOfTheSweepOut) {
  constexpr std::size_t kBeams = 360;
  constexpr double kStep_rad = 2.0 * kStraight_rad / kBeams;
  constexpr double kTimeStep_s = 0.1 / kBeams;  // ten turns a second
  const auto pose_after = [](double s) -> std::optional<geometry::Pose2> {
    return geometry::Pose2{1.0 * s, 0.0, 1.5 * s};  // 1 m/s, 86 degrees a second
  };
  std::vector<float> measured_m;
  for (std::size_t i = 0; i < kBeams; ++i) {
    const double beam = static_cast<double>(i);
    measured_m.push_back(static_cast<float>(
        to_wall_m(*pose_after(beam * kTimeStep_s), -kStraight_rad + beam * kStep_rad)));
  }
  ros::LaserScan message = laser_scan(-kStraight_rad, kStep_rad, measured_m);
  message.time_increment_(static_cast<float>(kTimeStep_s));
  const Sweep sweep = to_sweep(message, false);
  const std::vector<float> straight_m = deskewed(sweep, pose_after);
  ASSERT_EQ(straight_m.size(), kBeams);
  double skewed_error_m = 0.0;
  int none = 0;
  for (std::size_t i = 0; i < kBeams; ++i) {
    const double angle_rad = sweep.pattern.angle_min_rad + static_cast<double>(i) * kStep_rad;
    const double truth_m = to_wall_m({}, angle_rad);
    skewed_error_m =
        std::max(skewed_error_m, std::fabs(truth_m - static_cast<double>(measured_m[i])));
    if (straight_m[i] == 0.0F) {
      ++none;
      continue;
    }
    EXPECT_NEAR(static_cast<double>(straight_m[i]), truth_m, 0.06) << angle_rad;
  }
  EXPECT_GT(skewed_error_m, 0.2);
  EXPECT_LT(none, 12);  // where the turn has moved the gap between last and first beam
}

TEST(LaserScan, AStandingRobotsSweepStaysAsItIs) {
  ros::LaserScan message = laser_scan(-1.0, 0.1, {2.0F, 2.1F, 0.0F, 5.0F, 5.1F});
  message.time_increment_(0.001F);
  const Sweep sweep = to_sweep(message, false);
  const std::vector<float> same_m = deskewed(sweep, [](double) {
    return std::optional<geometry::Pose2>({3.0, 1.0, 0.5});
  });
  for (std::size_t i = 0; i < same_m.size(); ++i) EXPECT_NEAR(same_m[i], sweep.ranges_m[i], 1e-3);
}

}  // namespace
}  // namespace topogeo::ros_bridge
