#include "topogeo/devices/wheel_odometer.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using Verdict = WheelOdometer::Verdict;

constexpr std::int64_t kOdometerMs_ns = 1'000'000;

WheelOdometer odometer(unsigned tick_bits, unsigned time_bits) {
  return WheelOdometer({1000.0, 0.5, tick_bits, time_bits}, BaseLimits());
}

WheelReport report(std::uint32_t time_ms, std::uint32_t left, std::uint32_t right) {
  return {.time = time_ms, .ticks = {left, right}};
}

/// Takes a report at its own time.
Verdict take(WheelOdometer& odometer, const WheelReport& report) {
  return odometer.take(report, report.time * kOdometerMs_ns);
}

TEST(WheelOdometer, TicksBecomeAPose) {
  WheelOdometer wheels = odometer(32, 32);
  EXPECT_EQ(take(wheels, report(1000, 0, 0)), Verdict::kFirst);
  // 40 mm left, 60 mm right in 0.1 s: 50 mm ahead, and 20 mm / 0.5 m = 0.04 rad.
  ASSERT_EQ(take(wheels, report(1100, 40, 60)), Verdict::kMoved);
  const BaseOdometry& last = wheels.last();
  EXPECT_NEAR(last.linear_mps, 0.5, 1e-12);
  EXPECT_NEAR(last.angular_radps, 0.4, 1e-12);
  EXPECT_NEAR(last.T_odom_robot.theta_rad, 0.04, 1e-12);
  EXPECT_NEAR(last.T_odom_robot.x_m, 0.05 * std::cos(0.02), 1e-12);
  EXPECT_NEAR(last.T_odom_robot.y_m, 0.05 * std::sin(0.02), 1e-12);
  EXPECT_FALSE(wheels.rests());
  ASSERT_EQ(take(wheels, report(1200, 40, 60)), Verdict::kMoved);
  EXPECT_TRUE(wheels.rests());
}

TEST(WheelOdometer, CountsOfSixteenBitsWrapBothWays) {
  WheelOdometer wheels = odometer(16, 32);
  take(wheels, report(1000, 65'520, 10));
  ASSERT_EQ(take(wheels, report(1020, 4, 65'526)), Verdict::kMoved);
  // 20 ticks ahead on the left, 20 back on the right.
  EXPECT_NEAR(wheels.last().linear_mps, 0.0, 1e-12);
  EXPECT_NEAR(wheels.last().T_odom_robot.theta_rad, -0.04 / 0.5, 1e-12);
}

TEST(WheelOdometer, TimeOfSixteenBitsWraps) {
  WheelOdometer wheels = odometer(16, 16);
  EXPECT_EQ(wheels.take(report(65'530, 0, 0), 0), Verdict::kFirst);
  ASSERT_EQ(wheels.take(report(14, 10, 10), 20 * kOdometerMs_ns), Verdict::kMoved);
  EXPECT_NEAR(wheels.last().linear_mps, 0.5, 1e-12);
  // 65.536 s and 20 ms later.
  wheels.silent();
  ASSERT_EQ(wheels.take(report(34, 1000, 1000), 65'576 * kOdometerMs_ns), Verdict::kMoved);
  EXPECT_NEAR(wheels.last().linear_mps, 0.99 / 65.556, 1e-9);
}

TEST(WheelOdometer, AGyroReplacesTheHeadingOfTheWheels) {
  WheelOdometer rate = odometer(32, 32);
  take(rate, report(1000, 0, 0));
  WheelReport turned = report(1100, 40, 60);
  turned.turn_radps = 0.1;
  take(rate, turned);
  EXPECT_NEAR(rate.last().T_odom_robot.theta_rad, 0.01, 1e-12);

  WheelOdometer heading = odometer(32, 32);
  WheelReport before = report(1000, 0, 0);
  before.heading_rad = std::numbers::pi - 0.01;
  take(heading, before);
  turned = report(1100, 40, 60);
  turned.heading_rad = -std::numbers::pi + 0.02;
  take(heading, turned);
  EXPECT_NEAR(heading.last().T_odom_robot.theta_rad, 0.03, 1e-12);
  EXPECT_NEAR(heading.last().angular_radps, 0.3, 1e-9);
}

TEST(WheelOdometer, DoubtsAReportThatNoBaseCanHaveSent) {
  WheelOdometer wheels = odometer(32, 32);
  take(wheels, report(1000, 0, 0));
  EXPECT_EQ(take(wheels, report(1000, 0, 0)), Verdict::kDoubted) << "no time has passed";
  EXPECT_EQ(take(wheels, report(1020, 900, 0)), Verdict::kDoubted) << "45 m/s";
  EXPECT_EQ(take(wheels, report(1040, 10, 10)), Verdict::kMoved);
  EXPECT_NEAR(wheels.last().T_odom_robot.x_m, 0.01, 1e-12);
}

TEST(WheelOdometer, ThePoseGoesOnWhenTheBaseRestarts) {
  WheelOdometer wheels = odometer(32, 32);
  take(wheels, report(1'000'000, 0, 0));
  take(wheels, report(1'000'020, 10, 10));
  const std::int64_t later_ns = 1'002'000 * kOdometerMs_ns;
  EXPECT_EQ(wheels.take(report(20, 5000, 5000), later_ns), Verdict::kDoubted);
  EXPECT_EQ(wheels.take(report(40, 5010, 5010), later_ns + 20 * kOdometerMs_ns),
            Verdict::kRestarted);
  EXPECT_NEAR(wheels.last().T_odom_robot.x_m, 0.02, 1e-12);
}

TEST(WheelOdometer, CountsOfZeroAfterASilenceAreARestart) {
  WheelOdometer wheels = odometer(16, 32);
  take(wheels, report(1000, 300, 300));
  wheels.silent();
  EXPECT_EQ(take(wheels, report(3000, 0, 0)), Verdict::kDoubted) << "300 mm back are possible";
  EXPECT_EQ(take(wheels, report(3015, 0, 0)), Verdict::kRestarted);
  EXPECT_NEAR(wheels.last().T_odom_robot.x_m, 0.0, 1e-12);
}

// Both the time and the counts are too short to tell a restart from a motion.
TEST(WheelOdometer, ARestartAfterASilenceIsFoundWithShortCounts) {
  WheelOdometer wheels = odometer(16, 16);
  wheels.take(report(5000, 300, 300), 5000 * kOdometerMs_ns);
  wheels.silent();
  EXPECT_EQ(wheels.take(report(1000, 0, 0), 7000 * kOdometerMs_ns), Verdict::kDoubted);
  EXPECT_EQ(wheels.take(report(1020, 10, 10), 7020 * kOdometerMs_ns), Verdict::kRestarted);
  EXPECT_NEAR(wheels.last().T_odom_robot.x_m, 0.01, 1e-12);
}

TEST(WheelOdometer, RefusesUnitsOutOfRange) {
  EXPECT_THROW(WheelOdometer({0.5, 0.2}, BaseLimits()), std::invalid_argument);
  EXPECT_THROW(WheelOdometer({1000.0, 11.0}, BaseLimits()), std::invalid_argument);
  EXPECT_THROW(WheelOdometer({std::nan(""), 0.2}, BaseLimits()), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::devices
