#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/ros_conversions/laser_scan.hpp"

#include "ros_messages.hpp"

namespace topogeo::ros {
namespace {

constexpr double kStraight_rad = std::numbers::pi;

/// The range of a ray from a pose to the walls, for a robot that turns and drives during a sweep in
/// a square room of 6 m.
double to_wall_m(const geometry::Pose2& pose, double angle_rad) {
  const double heading = pose.theta_rad + angle_rad;
  const double x = std::cos(heading);
  const double y = std::sin(heading);
  const double along_x = x > 0.0 ? (3.0 - pose.x_m) / x : (-3.0 - pose.x_m) / x;
  const double along_y = y > 0.0 ? (3.0 - pose.y_m) / y : (-3.0 - pose.y_m) / y;
  return std::min(along_x, along_y);
}

TEST(Deskewing, TakesTheMotionOfTheSweepOut) {
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
  LaserScan message = laser_scan(-kStraight_rad, kStep_rad, measured_m);
  message.time_increment_(static_cast<float>(kTimeStep_s));
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kForward);
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
  EXPECT_LT(none, 12);  // when the turn has moved the gap between the last and the first beam
}

TEST(Deskewing, AStandingRobotsSweepStaysAsItIs) {
  LaserScan message = laser_scan(-1.0, 0.1, {2.0F, 2.1F, 0.0F, 5.0F, 5.1F});
  message.time_increment_(0.001F);
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kForward);
  const std::vector<float> same_m = deskewed(sweep, [](double) {
    return std::optional<geometry::Pose2>({3.0, 1.0, 0.5});
  });
  EXPECT_EQ(same_m, sweep.ranges_m);
}

// A clockwise scanner measures the last beam of its message first.
TEST(Deskewing, OfAClockwiseScannerGoesTheOtherWay) {
  LaserScan message = laser_scan(0.5, -0.25, {2.0F, 2.0F, 2.0F, 2.0F, 2.0F});
  message.time_increment_(0.1F);
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kForward);
  EXPECT_NEAR(sweep.first_beam_s, 0.4, 1e-6);
  EXPECT_NEAR(sweep.time_step_s, -0.1, 1e-6);
  const Sweep none = to_sweep(message, false, kMost);
  EXPECT_EQ(none.first_beam_s, 0.0);
  EXPECT_EQ(none.time_step_s, 0.0);
}

// Some drivers of clockwise scanners reverse the ranges, so the first one was measured last.
TEST(Deskewing, MayGoBackwardFromTheStamp) {
  LaserScan message = laser_scan(-0.5, 0.25, {2.0F, 2.0F, 2.0F, 2.0F, 2.0F});
  message.time_increment_(0.1F);
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kBackward);
  EXPECT_EQ(sweep.first_beam_s, 0.0);
  EXPECT_NEAR(sweep.time_step_s, -0.1, 1e-6);
  // 1 m/s ahead: seen from the pose at the stamp, the ray ahead (the third) met the wall 0.2 m
  // nearer than measured.
  const std::vector<float> ranges_m = deskewed(sweep, [](double after_s) {
    return std::optional<geometry::Pose2>({after_s, 0.0, 0.0});
  });
  EXPECT_NEAR(ranges_m[2], 1.8, 1e-3);
}

TEST(Deskewing, WithoutPosesLeavesTheRanges) {
  LaserScan message = laser_scan(-1.0, 0.1, {2.0F, 2.1F, 2.2F});
  message.time_increment_(0.01F);
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kForward);
  const auto poses_until = [](double end_s) {
    return [end_s](double s) -> std::optional<geometry::Pose2> {
      if (s > end_s) return std::nullopt;
      return geometry::Pose2{10.0 * s, 0.0, 0.0};
    };
  };
  EXPECT_EQ(deskewed(sweep, poses_until(-1.0)), sweep.ranges_m);
  EXPECT_EQ(deskewed(sweep, poses_until(0.015)), sweep.ranges_m);
  EXPECT_NE(deskewed(sweep, poses_until(0.5)), sweep.ranges_m);
}

// Odometry with absurd numbers, whose differences are not finite.
TEST(Deskewing, LeavesRangesAsMeasuredWherePosesAreNoNumbers) {
  constexpr std::size_t kBeams = 100;
  LaserScan message = laser_scan(-1.0, 0.02, std::vector<float>(kBeams, 2.0F));
  message.time_increment_(0.001F);
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kForward);
  const auto pose_after = [](double s) -> std::optional<geometry::Pose2> {
    if (s == 0.0) return geometry::Pose2{};
    return geometry::Pose2{NAN, 0.0, 0.0};
  };
  EXPECT_EQ(deskewed(sweep, pose_after).size(), kBeams);
  for (const float range_m : deskewed(sweep, pose_after)) EXPECT_NEAR(range_m, 2.0F, 1e-3F);
}

}  // namespace
}  // namespace topogeo::ros
