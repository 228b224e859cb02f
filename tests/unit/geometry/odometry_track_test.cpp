#include "topogeo/geometry/odometry_track.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::geometry {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kTolerance = 1e-12;

TEST(OdometryTrack, BetweenTwoSamplesIsOnTheWayBetweenThem) {
  OdometryTrack track(0);
  const double heading_rad = std::numbers::pi - 0.1;
  EXPECT_TRUE(track.add({100 * kMs, {1.0, 2.0, heading_rad}}));
  EXPECT_TRUE(track.add({200 * kMs, {2.0, 0.0, -heading_rad}}));  // over pi, the shorter way
  const auto answer = track.at(125 * kMs);
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->extrapolated);
  EXPECT_NEAR(answer->T_odom_robot.x_m, 1.25, kTolerance);
  EXPECT_NEAR(answer->T_odom_robot.y_m, 1.5, kTolerance);
  EXPECT_NEAR(answer->T_odom_robot.theta_rad, std::numbers::pi - 0.05, kTolerance);
  EXPECT_EQ(track.at(100 * kMs)->T_odom_robot, (Pose2{1.0, 2.0, heading_rad}));
  EXPECT_EQ(track.at(200 * kMs)->T_odom_robot, (Pose2{2.0, 0.0, -heading_rad}));
}

TEST(OdometryTrack, AfterTheLastSampleItsSpeedsGoOn) {
  OdometryTrack track(500 * kMs);
  track.add({0, {0.0, 0.0, std::numbers::pi / 2.0}, 0.5, 0.0});
  const auto straight = track.at(200 * kMs);
  ASSERT_TRUE(straight);
  EXPECT_TRUE(straight->extrapolated);
  EXPECT_NEAR(straight->T_odom_robot.x_m, 0.0, kTolerance);
  EXPECT_NEAR(straight->T_odom_robot.y_m, 0.1, kTolerance);
  track.add({1000 * kMs, {0.0, 0.0, 0.0}, 0.5, 0.5});
  const auto arc = track.at(1200 * kMs);
  ASSERT_TRUE(arc);
  EXPECT_NEAR(arc->T_odom_robot.theta_rad, 0.1, kTolerance);
  // A circle of 1 m: arc and chord differ by half a millimetre at most.
  EXPECT_NEAR(arc->T_odom_robot.x_m, std::sin(0.1), 5e-4);
  EXPECT_NEAR(arc->T_odom_robot.y_m, 1.0 - std::cos(0.1), 5e-4);
}

TEST(OdometryTrack, WhatIsNotKnownIsNotAnswered) {
  OdometryTrack track(500 * kMs);
  EXPECT_FALSE(track.at(0));
  EXPECT_FALSE(track.last_ns());
  track.add({100 * kMs, {}});
  EXPECT_FALSE(track.at(99 * kMs));
  EXPECT_TRUE(track.at(600 * kMs));
  EXPECT_FALSE(track.at(600 * kMs + 1));
  EXPECT_FALSE(track.add({100 * kMs, {9.0, 9.0, 9.0}}));  // not after the previous one
  EXPECT_EQ(track.at(100 * kMs)->T_odom_robot, Pose2{});
  track.add({100 * kMs + OdometryTrack::kKept_ns + 1, {}});
  EXPECT_FALSE(track.at(100 * kMs));  // forgotten
}

}  // namespace
}  // namespace topogeo::geometry
