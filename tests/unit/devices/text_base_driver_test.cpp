#include "topogeo/devices/text_base_driver.hpp"

#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/text_base_emulator.hpp"

#include "two_wheels_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::TextBaseEmulatorSettings;
using testing::HasSubstr;

BaseSettings text_settings() {
  BaseSettings settings;
  settings.line.baud = 115'200;
  settings.battery_low_v = 10.5;
  return settings;
}

struct TextBaseOnLine : TwoWheelsOnLine<TextBaseDriver, simulation::TextBaseEmulator> {
  explicit TextBaseOnLine(const BaseSettings& settings = text_settings(),
                          const TextBaseEmulatorSettings& base = {})
      : TwoWheelsOnLine(settings, base) {}
};

TEST(TextBaseDriver, DrivesASquareAndKnowsWhereItIs) {
  TextBaseOnLine base;
  drive_a_square(base, 12.3);
}

TEST(TextBaseDriver, ABaseThatMixesGetsTheSameMotion) {
  BaseSettings settings = text_settings();
  settings.text.mixes = true;
  TextBaseOnLine base(settings);
  ASSERT_TRUE(base.start());
  base.drive(0.2, 0.3, 3 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  base.expect_pose(0.02);
  EXPECT_GT(base.truth.theta_rad, 0.5);
}

TEST(TextBaseDriver, TheHeadingFollowsAGyro) {
  BaseSettings wide = text_settings();
  wide.text.track_m = 0.4;  // twice the true one: the wheels would show half the turn
  TextBaseOnLine base(wide, {.gyro = true});
  ASSERT_TRUE(base.start());
  base.drive(0.0, 0.3, 3 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.truth.theta_rad, 1.0);
  EXPECT_NEAR(base.last.T_odom_robot.theta_rad, base.truth.theta_rad, 0.05);
}

TEST(TextBaseDriver, AnotherVersionIsRefusedWithAReason) {
  TextBaseOnLine base(text_settings(), {.version = 2});
  EXPECT_FALSE(base.start());
  EXPECT_THAT(base.driver.status().reason, HasSubstr("version 2"));
}

TEST(TextBaseDriver, AnEmergencyStopHoldsUntilAReset) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.emulator.press_emergency_stop();
  base.drive(0.3, 0.0, 200 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  base.emulator.release_emergency_stop();
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  expect_reset_before_motion(base);
}

TEST(TextBaseDriver, AFastCommandIsSlowerOnTheSameArc) {
  TextBaseOnLine base;
  keep_the_arc_of_fast_commands(base);
}

TEST(TextBaseDriver, ABumperStopsTheBaseAndLetsItBackOff) {
  TextBaseOnLine base;
  back_off_from_a_bump(base, 1U);
}

TEST(TextBaseDriver, ALowBatteryIsReported) {
  TextBaseOnLine base(text_settings(), {.battery_v = 10.2});
  ASSERT_TRUE(base.start());
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_TRUE(base.driver.status().battery_low);
  EXPECT_FALSE(base.driver.status().battery_percent);
}

TEST(TextBaseDriver, TheChargeOfABaseThatMeasuresItIsReported) {
  TextBaseOnLine base(text_settings(), {.battery_percent = 64});
  ASSERT_TRUE(base.start());
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_EQ(base.driver.status().battery_percent, 64.0);
}

TEST(TextBaseDriver, ThePoseGoesOnWhenTheBaseRestarts) {
  TextBaseOnLine base;
  restart_on_the_way(base, 3 * kWheelsSecond_ns);
}

TEST(TextBaseDriver, WhatWasDrivenUnheardIsInThePose) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  base.emulator.set_fault(simulation::BaseFault::kSilent, true);
  base.drive(0.3, 0.2, 3 * kWheelsSecond_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kOffline);
  base.emulator.set_fault(simulation::BaseFault::kSilent, false);
  base.pass(2 * kWheelsSecond_ns);
  ASSERT_TRUE(base.driver.status().commands_taken);
  EXPECT_EQ(base.driver.status().restarts, 0U);
  base.expect_pose(0.03);
}

TEST(TextBaseDriver, RefusesSettingsOutOfRange) {
  expect_settings_refused<TextBaseDriver>(text_settings(),
                                          {[](BaseSettings& s) { s.text.ticks_per_m = 0.0; },
                                           [](BaseSettings& s) { s.text.track_m = 20.0; },
                                           [](BaseSettings& s) { s.watchdog_s = 0.0; }});
}

class TextBaseFaults : public testing::TestWithParam<TwoWheelFault<TextBaseOnLine>> {};

TEST_P(TextBaseFaults, AThousandTimes) {
  TextBaseOnLine base;
  strike_a_thousand_times(base, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, TextBaseFaults, testing::ValuesIn(two_wheel_faults<TextBaseOnLine>()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
