// The driver of the base against the emulated base, on a simulated clock: start-up, motion,
// odometry, silence and restarts.
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/devices/base_start.hpp"

#include "base_lines.hpp"

namespace topogeo::devices {
namespace {

using testing::Contains;

constexpr double kPi = std::numbers::pi;

class BaseDriverOn : public BaseOnAnyLine {};

INSTANTIATE_TEST_SUITE_P(Dialects, BaseDriverOn, testing::ValuesIn(kWays), name_of);

TEST_P(BaseDriverOn, StartsTheBaseUp) {
  BaseOnLine all(settings());
  EXPECT_EQ(all.driver.status().state, BaseState::kOffline);
  ASSERT_TRUE(all.start(4 * kSecond));
  const auto& orders = all.base.mcp.orders();
  EXPECT_THAT(orders, Contains(McpOrder{McpCommand::kJoystickOff, 1}));
  EXPECT_THAT(orders, Contains(watchdog_order(settings())));
  EXPECT_EQ(all.base.mcp.binary(), GetParam().dialect == BaseDialect::kBinary);
  EXPECT_TRUE(all.base.mcp.binary() || !all.base.mcp.echoes());
  const auto position = [&](McpCommand command) {
    return std::ranges::find(orders, command, &McpOrder::command) - orders.begin();
  };
  EXPECT_LT(position(McpCommand::kReportMask), position(McpCommand::kReportPeriod));
  EXPECT_EQ(all.driver.status().reason, "");
  EXPECT_TRUE(all.driver.status().commands_taken);
}

TEST_P(BaseDriverOn, KeepsTheWatchdogFedAndReportsComing) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  const BaseStatus before = all.driver.status();
  all.pass(30 * kSecond);
  const double reports = static_cast<double>(all.driver.status().reports - before.reports);
  EXPECT_NEAR(reports, 30.0 / period_s(), 2.0);
  EXPECT_EQ(all.driver.status().watchdog_expirations, 0U);
  EXPECT_EQ(all.driver.status().starts, before.starts);
  EXPECT_EQ(all.driver.status().drops, before.drops);
  EXPECT_DOUBLE_EQ(all.driver.status().battery_v, 48.2);
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
}

TEST_P(BaseDriverOn, DrivesAsCommandedAndSaysWhereItIs) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 5 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  EXPECT_NEAR(all.base.mcp.commanded_velocity().linear_m_per_s, 0.3, 1e-4);
  all.drive(0.2, 0.5, 5 * kSecond);
  EXPECT_NEAR(all.base.mcp.commanded_velocity().angular_rad_per_s, 0.5, 0.01);
  all.drive(-0.2, -0.3, 5 * kSecond);
  EXPECT_NEAR(all.base.mcp.commanded_velocity().linear_m_per_s, -0.2, 1e-4);
  EXPECT_NEAR(all.base.mcp.commanded_velocity().angular_rad_per_s, -0.3, 0.01);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  all.drive(0.0, 0.0, 3 * kSecond);
  EXPECT_TRUE(all.base.stands());
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
  EXPECT_GT(all.T_odom_robot.position_m().norm(), 1.0);
  EXPECT_LT(all.worst_m, 0.02);    // two units of the base's registers
  EXPECT_LT(all.worst_rad, 0.02);  // three
  EXPECT_EQ(all.stamps_back, 0U);
  EXPECT_EQ(all.stamps_ahead, 0U);
}

TEST_P(BaseDriverOn, SaysOnlyWhatChanges) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  all.base.mcp.forget_orders();
  all.drive(0.3, 0.0, 2 * kSecond);
  for (const McpOrder& order : all.base.mcp.orders()) {
    EXPECT_NE(order.command, McpCommand::kTranslatePlus);
    EXPECT_NE(order.command, McpCommand::kTranslateVelocity);
    EXPECT_NE(order.command, McpCommand::kRotateHalt);
  }
}

TEST_P(BaseDriverOn, AdvancesAndTurnsByAnAmount) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  const auto done = [&] { return all.driver.primitive_done(); };
  const auto soon_ns = [&] { return all.line.now_ns() + 60 * kSecond; };
  ASSERT_TRUE(all.driver.advance(1.5, soon_ns(), all.line.now_ns()));
  ASSERT_TRUE(all.pass_until(20 * kSecond, done));
  EXPECT_NEAR(all.base.mcp.T_start_robot().x_m, 1.5, 0.005);
  ASSERT_TRUE(all.driver.turn(kPi / 2, soon_ns(), all.line.now_ns()));
  ASSERT_TRUE(all.pass_until(20 * kSecond, done));
  EXPECT_NEAR(all.base.mcp.T_start_robot().theta_rad, kPi / 2, 0.02);
  ASSERT_TRUE(all.driver.advance(-0.5, soon_ns(), all.line.now_ns()));
  ASSERT_TRUE(all.pass_until(20 * kSecond, done));
  EXPECT_NEAR(all.base.mcp.T_start_robot().y_m, -0.5, 0.02);
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
  // Two equal ones are counted separately.
  ASSERT_TRUE(all.driver.advance(0.25, soon_ns(), all.line.now_ns()));
  ASSERT_TRUE(all.pass_until(20 * kSecond, done));
  ASSERT_TRUE(all.driver.advance(0.25, soon_ns(), all.line.now_ns()));
  ASSERT_TRUE(all.pass_until(20 * kSecond, done));
  EXPECT_NEAR(all.base.mcp.T_start_robot().y_m, 0.0, 0.02);
  EXPECT_LT(all.worst_m, 0.02);
}

TEST_P(BaseDriverOn, AMoveEndsWhenItIsNoLongerValid) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  ASSERT_TRUE(all.driver.advance(5.0, all.line.now_ns() + 2 * kSecond, all.line.now_ns()));
  EXPECT_TRUE(all.pass_until(4 * kSecond, [&] { return all.driver.primitive_done(); }));
  all.pass(2 * kSecond);
  EXPECT_TRUE(all.base.stands());
  EXPECT_LT(all.base.mcp.T_start_robot().x_m, 1.5);
}

/// The driver's commands do not reach the base, but its reports reach the driver.
TEST_P(BaseDriverOn, LimitsHoldAtOnceAndNeverExceedTheSettings) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(2.0, 0.0, 3 * kSecond);
  EXPECT_NEAR(all.base.mcp.commanded_velocity().linear_m_per_s, 0.5, 1e-4);
  all.driver.set_limits({.linear_mps = 0.2, .linear_mps2 = 9.0}, all.line.now_ns());
  EXPECT_DOUBLE_EQ(all.driver.limits().linear_mps2, 0.5);
  all.drive(2.0, 0.0, 3 * kSecond);
  EXPECT_NEAR(all.base.mcp.commanded_velocity().linear_m_per_s, 0.2, 1e-4);
  all.drive(0.3, 0.5, 3 * kSecond);  // on the same curve
  EXPECT_NEAR(all.base.mcp.commanded_velocity().angular_rad_per_s, 0.5 * 2.0 / 3.0, 0.01);
  EXPECT_THROW(all.driver.set_limits({.angular_radps = 0.0}, all.line.now_ns()),
               std::invalid_argument);
}

TEST_P(BaseDriverOn, ARestartedBaseIsSetUpAgainAndThePoseGoesOn) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.3, 5 * kSecond);
  all.drive(0.0, 0.0, 2 * kSecond);
  const geometry::Pose2 before = all.T_odom_robot;
  all.base.mcp.switch_on(all.line.now_ns());
  all.pass(kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kOffline);
  const std::uint64_t odometries = all.odometries;
  // The start-up time of 2 s plus another second.
  EXPECT_TRUE(
      all.pass_until(2 * kSecond, [&] { return all.driver.status().state == BaseState::kReady; }));
  all.pass(kSecond);
  EXPECT_GT(all.odometries, odometries);
  EXPECT_EQ(all.driver.status().restarts, 1U);
  EXPECT_LT(geometry::difference(all.T_odom_robot, before).norm(), 0.02);
  all.drive(0.3, 0.0, 5 * kSecond);
  EXPECT_LT(all.worst_m, 0.03);
  EXPECT_EQ(all.stamps_back, 0U);
}

TEST_P(BaseDriverOn, ASilentBaseIsOfflineUntilItsNextReport) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  for (const std::int64_t silence_ns : {kSecond, 7 * kSecond, 100 * kSecond}) {
    all.base.mcp.line_faults().set_silent(true);
    all.drive(0.3, 0.0, silence_ns);
    EXPECT_EQ(all.driver.status().state, BaseState::kOffline);
    EXPECT_TRUE(silence_ns < 2 * kSecond || all.base.stands());
    all.base.mcp.line_faults().set_silent(false);
    const std::uint64_t before = all.odometries;
    all.pass(2 * period_ns() + 60 * kMs);
    EXPECT_GT(all.odometries, before) << silence_ns;
    EXPECT_TRUE(all.pass_until(2 * kSecond, [&] { return all.driver.status().commands_taken; }));
    all.drive(0.3, 0.0, 2 * kSecond);
    EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  }
  EXPECT_LT(all.worst_m, 0.03);
  EXPECT_EQ(all.stamps_back, 0U);
  EXPECT_EQ(all.driver.status().restarts, 0U);
}

TEST_P(BaseDriverOn, AClockThatWrapsAndDriftsDoesNotShow) {
  BaseOnLine all(settings(), {.clock_at_start = 0xFFFFFFFF - 256 * 20, .clock_drift_ppm = 200.0});
  ASSERT_TRUE(all.start());
  const McpDrops before = all.driver.status().drops;
  for (int i = 0; i < 60; ++i) all.drive(i % 2 == 0 ? 0.3 : -0.3, 0.2, kSecond);
  EXPECT_EQ(all.driver.status().restarts, 0U);
  EXPECT_EQ(all.driver.status().drops, before);
  EXPECT_LT(all.worst_m, 0.02);
}

TEST(BaseDriver, GoesOnWithABaseThatEchoesForEverPromptsAndWritesCapitals) {
  BaseOnLine all({}, {.form = {.line_end = "\r", .upper_case = true},
                      .prompt = true,
                      .echo_can_be_switched_off = false});
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.2, 20 * kSecond);
  all.pass(2 * kSecond);
  EXPECT_GT(all.driver.status().echoes, 20U);
  EXPECT_GT(static_cast<double>(all.driver.status().reports), 0.8 * 22 / 0.125);
  EXPECT_LT(all.worst_m, 0.02);
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
  EXPECT_DOUBLE_EQ(all.driver.status().battery_v, 48.2);
}

TEST(BaseDriver, StaysOfflineOnALineWithOtherSettings) {
  BaseSettings settings;
  BaseOnLine all(settings);
  settings.line.baud = 38400;
  RwiDriver fast(settings);
  SimulatedLine line(fast, all.base);
  line.plug_in();
  line.run_for(60 * kSecond);
  EXPECT_EQ(fast.status().state, BaseState::kOffline);
  EXPECT_EQ(fast.status().reason, "the base does not answer");
  EXPECT_TRUE(fast.take_odometry().empty());
  EXPECT_GT(fast.status().starts, 3U);
}

TEST(BaseDriver, TakesABaseThatIsInTheBinaryDialectAlready) {
  BaseSettings settings;
  settings.dialect = BaseDialect::kBinary;
  BaseOnLine all(settings);
  ASSERT_TRUE(all.start());
  RwiDriver second(settings);
  SimulatedLine line(second, all.base, all.line.now_ns());
  line.plug_in();
  EXPECT_TRUE(
      line.run_until(3 * kSecond, [&] { return second.status().state == BaseState::kReady; }));
}

TEST(BaseDriver, RefusesSettingsOutOfRange) {
  const auto refuses = [](auto change) {
    BaseSettings settings;
    change(settings);
    EXPECT_THROW(RwiDriver{settings}, std::invalid_argument);
  };
  refuses([](BaseSettings& s) { s.watchdog_s = 0.0; });
  refuses([](BaseSettings& s) { s.watchdog_s = 256.0; });
  refuses([](BaseSettings& s) { s.command_timeout_s = 0.6; });
  refuses([](BaseSettings& s) { s.limits.linear_mps = std::nan(""); });
  refuses([](BaseSettings& s) { s.line.baud = 0; });
  refuses([](BaseSettings& s) { s.report_mask = 2; });
  refuses([](BaseSettings& s) { s.calibration.counts_per_m = -1.0; });
  refuses([](BaseSettings& s) { s.stalled_reports = 1; });
  refuses([](BaseSettings& s) { s.ripple_mps = 0.0; });
  refuses([](BaseSettings& s) { s.ramp_radps = -1.0; });
}

TEST(BaseDriver, RefusesCommandsThatAreNoNumbers) {
  RwiDriver driver({});
  EXPECT_THROW((void)driver.command(std::nan(""), 0, 1, 0), std::invalid_argument);
  EXPECT_THROW((void)driver.advance(std::numeric_limits<double>::infinity(), 1, 0),
               std::invalid_argument);
}
}  // namespace
}  // namespace topogeo::devices
