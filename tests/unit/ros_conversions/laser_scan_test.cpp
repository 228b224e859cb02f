#include "topogeo/ros_conversions/laser_scan.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/ros_conversions/frame_tree.hpp"

#include "ros_messages.hpp"

namespace topogeo::ros {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Beams at -0.5, 0, 0.5 and 1 rad.
LaserScan four_beams() {
  LaserScan scan = laser_scan(-0.5, 0.5, {1.0F, 2.0F, 3.0F, 4.0F});
  scan.range_max_(10.0F);
  return scan;
}

TEST(LaserScan, BeamsGoCounterClockwise) {
  const Sweep sweep = to_sweep(four_beams(), false, kMost);
  EXPECT_DOUBLE_EQ(sweep.pattern.angle_min_rad, -0.5);
  EXPECT_DOUBLE_EQ(sweep.pattern.angle_step_rad, 0.5);
  EXPECT_EQ(sweep.pattern.beams, 4U);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(1.0F, 2.0F, 3.0F, 4.0F));
}

TEST(LaserScan, WithoutAStepBetweenBeamsEndsAtItsLastAngle) {
  LaserScan message = four_beams();
  message.angle_increment_(0.0F);
  message.angle_max_(1.0F);
  const Sweep sweep = to_sweep(message, false, kMost);
  EXPECT_DOUBLE_EQ(sweep.pattern.angle_min_rad, -0.5);
  EXPECT_DOUBLE_EQ(sweep.pattern.angle_step_rad, 0.5);
}

TEST(LaserScan, OfAClockwiseScannerIsTurnedRound) {
  LaserScan message = four_beams();
  message.angle_min_(1.0F);
  message.angle_increment_(-0.5F);
  const Sweep sweep = to_sweep(message, false, kMost);
  EXPECT_DOUBLE_EQ(sweep.pattern.angle_min_rad, -0.5);
  EXPECT_DOUBLE_EQ(sweep.pattern.angle_step_rad, 0.5);
  EXPECT_THAT(sweep.ranges_m, ElementsAre(4.0F, 3.0F, 2.0F, 1.0F));
}

// Each beam's end must agree with the spatial transform.
TEST(LaserScan, OfALaserUpsideDownIsMirrored) {
  const Eigen::Isometry3d T_robot_laser = at(0.3, 0.1, 0.7, std::numbers::pi);
  const LaserMounting mounting = planar_mounting(T_robot_laser);
  const LaserScan message = four_beams();
  const Sweep sweep = to_sweep(message, mounting.upside_down, kMost);
  for (std::size_t i = 0; i < 4; ++i) {
    const double angle = -0.5 + 0.5 * static_cast<double>(i);
    const auto range = static_cast<double>(message.ranges_()[i]);
    const Eigen::Vector3d end =
        T_robot_laser * Eigen::Vector3d(range * std::cos(angle), range * std::sin(angle), 0.0);
    const std::size_t beam = 3 - i;
    ASSERT_EQ(sweep.ranges_m[beam], message.ranges_()[i]);
    const double ours =
        sweep.pattern.angle_min_rad + static_cast<double>(beam) * sweep.pattern.angle_step_rad;
    const Eigen::Vector2d our_end =
        mounting.T_robot_laser * Eigen::Vector2d(range * std::cos(ours), range * std::sin(ours));
    EXPECT_NEAR(our_end.x(), end.x(), 1e-6);
    EXPECT_NEAR(our_end.y(), end.y(), 1e-6);
  }
}

TEST(LaserScan, HasNoEchoesOutsideItsLimits) {
  LaserScan message = four_beams();
  message.ranges_({0.0F, 0.05F, 0.1F, 9.9F, 10.0F, kInf, -kInf,
                   std::numeric_limits<float>::quiet_NaN(), -1.0F});
  EXPECT_THAT(to_sweep(message, false, kMost).ranges_m,
              ElementsAre(0.0F, 0.0F, 0.1F, 9.9F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F));
  message.range_max_(0.0F);  // a driver that leaves it unset
  std::vector<float> ranges_m = to_sweep(message, false, kMost).ranges_m;
  EXPECT_THAT(ranges_m, ElementsAre(0.0F, 0.0F, 0.1F, 9.9F, 10.0F, 0.0F, 0.0F, 0.0F, 0.0F));
  limit_ranges(ranges_m, 9.9);
  EXPECT_THAT(ranges_m, ElementsAre(0.0F, 0.0F, 0.1F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F));
}

TEST(LaserScan, OfTooManyBeamsKeepsEveryOther) {
  LaserScan message = four_beams();
  message.angle_increment_(0.001F);
  message.time_increment_(0.00001F);
  message.ranges_().assign(3000, 1.0F);
  message.ranges_()[2] = 2.0F;
  const Sweep sweep = to_sweep(message, false, kMost, SweepOrder::kForward);
  EXPECT_EQ(sweep.ranges_m.size(), 1500U);
  EXPECT_EQ(sweep.pattern.beams, 1500U);
  EXPECT_EQ(sweep.ranges_m[1], 2.0F);
  EXPECT_NEAR(sweep.pattern.angle_step_rad, 0.002, 1e-9);
  EXPECT_NEAR(sweep.time_step_s, 0.00002, 1e-9);
  message.angle_increment_(-0.001F);
  EXPECT_EQ(to_sweep(message, false, kMost).ranges_m[1498], 2.0F);  // the same beams
}

TEST(LaserScan, IsRefusedWithBeamsOfNoLaser) {
  const auto error_of = [](const LaserScan& message,
                           SweepOrder order = SweepOrder::kNone) -> std::string {
    try {
      (void)to_sweep(message, false, kMost, order);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  for (const float step : {0.0F, 7.0F, std::numeric_limits<float>::quiet_NaN()}) {
    LaserScan message = four_beams();
    message.angle_increment_(step);
    message.angle_max_(message.angle_min_());
    EXPECT_THAT(error_of(message), HasSubstr("angle_increment: expected 0.00001 or more"));
  }
  LaserScan message = four_beams();
  message.ranges_({1.0F});
  EXPECT_THAT(error_of(message), HasSubstr("ranges: expected 2 or more, got 1"));
  message = four_beams();
  message.angle_min_(std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(error_of(message), HasSubstr("angle_min"));
  for (const float step_s : {-1.0F, 100.0F, std::numeric_limits<float>::infinity(),
                             std::numeric_limits<float>::quiet_NaN()}) {
    message = four_beams();
    message.time_increment_(step_s);
    EXPECT_THAT(error_of(message, SweepOrder::kForward), HasSubstr("time_increment"));
    EXPECT_EQ(error_of(message), "");  // not used
  }
}

TEST(LaserScan, PutsOtherNumbersOfBeamsOnOnePattern) {
  const Sweep sweep = to_sweep(laser_scan(0.01, 0.1, {1.0F, 2.0F, 3.0F}), false, kMost);
  EXPECT_THAT(on_pattern(sweep, {-0.1, 0.1, 5}), ElementsAre(0.0F, 1.0F, 2.0F, 3.0F, 0.0F));
}

TEST(SweepOrder, HasAName) {
  EXPECT_EQ(sweep_order("none"), SweepOrder::kNone);
  EXPECT_EQ(sweep_order("forward"), SweepOrder::kForward);
  EXPECT_EQ(sweep_order("backward"), SweepOrder::kBackward);
  EXPECT_THROW((void)sweep_order("sideways"), std::invalid_argument);
}

TEST(BeamPattern, AreAlikeWhereBeamsLack) {
  const BeamPattern whole{-1.0, 0.01, 201};
  EXPECT_TRUE(same_beams(whole, {-1.00005, 0.01, 201}));
  EXPECT_FALSE(same_beams(whole, {-1.0, 0.01, 200}));
  EXPECT_FALSE(same_beams(whole, {-1.0, 0.010001, 201}));  // 0.0002 rad at the end
  EXPECT_TRUE(alike(whole, {-1.0, 0.01, 190}));
  EXPECT_TRUE(alike(whole, {-1.0, 0.02, 101}));
  EXPECT_FALSE(alike(whole, {-1.0, 0.01, 20}));
  EXPECT_FALSE(alike(whole, {-1.0, 0.03, 67}));
  EXPECT_FALSE(alike(whole, {0.5, 0.01, 201}));
}

TEST(LaserScan, IsWrittenWithoutEchoesAsInfinite) {
  scan::Scan scan;
  scan.stamp_ns = 1'500'000'000;
  scan.angle_min_rad = -0.5;
  scan.angle_step_rad = 0.5;
  scan.ranges_m = {1.0F, scan::Scan::kNoReturn, 3.0F};
  const LaserScan message = to_laser_scan(scan, "laser", 30.0F);
  EXPECT_EQ(message.header_().stamp_().sec_(), 1);
  EXPECT_EQ(message.header_().frame_id_(), "laser");
  EXPECT_EQ(message.angle_max_(), 0.5F);
  EXPECT_EQ(message.range_max_(), 30.0F);
  EXPECT_THAT(message.ranges_(), ElementsAre(1.0F, kInf, 3.0F));
  EXPECT_EQ(to_sweep(message, false, kMost).ranges_m, scan.ranges_m);
}

}  // namespace
}  // namespace topogeo::ros
