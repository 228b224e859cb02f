#include "topogeo/devices/mcp_units.hpp"

#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/devices/sonar_ring.hpp"

namespace topogeo::devices {
namespace {

constexpr double kHalfTurn_rad = std::numbers::pi;

McpReport at(std::uint16_t x, std::uint16_t y, std::uint16_t heading) {
  McpReport report;
  report.fields[static_cast<std::size_t>(McpField::kX)] = x;
  report.fields[static_cast<std::size_t>(McpField::kY)] = y;
  report.fields[static_cast<std::size_t>(McpField::kHeading)] = heading;
  return report;
}

TEST(McpUnits, ConvertsByTheGearingOfTheB21) {
  const McpUnits units{McpCalibration{}};
  EXPECT_EQ(units.counts(0.1), 2812);
  EXPECT_DOUBLE_EQ(units.metres(2812), 0.1);
  EXPECT_NEAR(units.position_m(0x6E), 1.0, 0.005);            // 110 units of 9.10 mm
  EXPECT_EQ(units.rotation_counts(-kHalfTurn_rad / 2), 256);  // clockwise
  EXPECT_DOUBLE_EQ(units.radians(256), -kHalfTurn_rad / 2);
}

TEST(McpUnits, TurnsSignsAsCalibrated) {
  const McpUnits units{{.clockwise_positive = false, .reversed = true}};
  EXPECT_EQ(units.counts(0.1), -2812);
  EXPECT_EQ(units.rotation_counts(kHalfTurn_rad / 2), 256);
}

TEST(McpUnits, TakesTheSignOfASpeedFromTheStatus) {
  const McpUnits units{McpCalibration{}};
  McpReport report;
  report.fields[9] = 2812;
  report.fields[17] = 128;
  EXPECT_DOUBLE_EQ(units.linear_mps(report), 0.1);
  EXPECT_DOUBLE_EQ(units.angular_radps(report), -kHalfTurn_rad / 4);
  report.fields[11] = 0x0800;
  report.fields[19] = 0x0800;
  EXPECT_DOUBLE_EQ(units.linear_mps(report), -0.1);
  EXPECT_DOUBLE_EQ(units.angular_radps(report), kHalfTurn_rad / 4);
}

TEST(McpUnits, RefusesCalibrationsThatCannotBe) {
  EXPECT_THROW(McpUnits({.counts_per_m = 0.0}), std::invalid_argument);
  EXPECT_THROW(McpUnits({.position_units_per_m = -1.0}), std::invalid_argument);
  EXPECT_THROW(McpUnits({.rotation_counts_per_turn = std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
}

TEST(McpPoseTracker, LooksAheadAlongY) {
  McpPoseTracker tracker{McpUnits{{.position_units_per_m = 100.0}}};
  // One metre to the base's right, two ahead, turned clockwise by a quarter.
  const geometry::Pose2 pose = tracker.track(at(0x8000 + 100, 0x8000 + 200, 256));
  EXPECT_DOUBLE_EQ(pose.x_m, 2.0);
  EXPECT_DOUBLE_EQ(pose.y_m, -1.0);
  EXPECT_DOUBLE_EQ(pose.theta_rad, -kHalfTurn_rad / 2);
}

TEST(McpPoseTracker, FollowsRegistersOverTheirEnds) {
  McpPoseTracker tracker{McpUnits{{.position_units_per_m = 100.0}}};
  (void)tracker.track(at(0x8000, 0xFFF0, 0xFFFF));
  EXPECT_DOUBLE_EQ(tracker.peek(at(0x8000, 0x0010, 0)).x_m, 327.84);
  const geometry::Pose2 over = tracker.track(at(0x8000, 0x0010, 0x0000));
  EXPECT_DOUBLE_EQ(over.x_m, 327.84);
  EXPECT_DOUBLE_EQ(over.theta_rad, 0.0);
  const geometry::Pose2 back = tracker.track(at(0x8000, 0xFFF0, 0x0400));
  EXPECT_DOUBLE_EQ(back.x_m, 327.52);
  EXPECT_NEAR(back.theta_rad, 0.0, 1e-12);  // a whole turn
}

TEST(McpClock, RunsOnOverItsEnd) {
  McpClock clock;
  EXPECT_EQ(clock.follow(0xFFFFFF80), 0);
  EXPECT_EQ(clock.since_last_ns(0x80), 1'000'000'000);
  EXPECT_EQ(clock.follow(0x80), 1'000'000'000);
  EXPECT_EQ(clock.since_last_ns(0), -500'000'000);
  clock.restart();
  EXPECT_EQ(clock.follow(7), 0);
}

TEST(SonarRing, LooksAllAroundFromTheRim) {
  const auto ring = b21_sonars();
  ASSERT_EQ(ring.size(), 24U);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const SonarMount& mount = ring[i];
    EXPECT_NEAR(mount.T_robot_sonar.position_m().norm(), kB21Radius_m, 1e-12);
    const geometry::Pose2 bearing{0, 0,
                                  (static_cast<double>(i) * 15.0 + 7.5) * kHalfTurn_rad / 180.0};
    EXPECT_NEAR(geometry::between(bearing, mount.T_robot_sonar).theta_rad, 0.0, 1e-12);
  }
  const auto six = macondo_sonars();
  ASSERT_EQ(six.size(), 6U);
  EXPECT_EQ(six[0].T_robot_sonar.theta_rad, 0.0);
  EXPECT_GT(six[2].T_robot_sonar.y_m, 0.2);
  EXPECT_DOUBLE_EQ(six[2].T_robot_sonar.theta_rad, kHalfTurn_rad / 2);
  EXPECT_DOUBLE_EQ(six[5].T_robot_sonar.theta_rad, -kHalfTurn_rad / 2);
}

}  // namespace
}  // namespace topogeo::devices
