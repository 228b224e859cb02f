#include "topogeo/devices/text_base_driver.hpp"

#include <functional>
#include <stdexcept>
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
  ASSERT_TRUE(base.start()) << base.driver.status().reason;
  for (int side = 0; side < 4; ++side) {
    base.drive(0.3, 0.0, 3 * kWheelsSecond_ns);
    base.drive(0.0, 0.5, 3 * kWheelsSecond_ns);
  }
  base.drive(0.0, 0.0, 2 * kWheelsSecond_ns);
  base.expect_pose(0.02);
  EXPECT_LE(base.fastest_mps, 0.31);
  EXPECT_TRUE(base.driver.stands());
  EXPECT_NEAR(base.driver.status().battery_v, 12.3, 1e-9);
  EXPECT_FALSE(base.driver.status().battery_low);
  for (const std::uint64_t drops : base.driver.status().drops) EXPECT_EQ(drops, 0U);
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
  EXPECT_EQ(base.speed_mps(), 0.0) << "a command alone moves nothing";
  base.driver.reset_stop(base.line.now_ns());
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.speed_mps(), 0.1);
}

TEST(TextBaseDriver, ABumperStopsTheBaseAndLetsItBackOff) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.emulator.press_bumpers(1, base.line.now_ns());
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kBumped);
  base.pass(kWheelsSecond_ns);
  base.drive(0.3, 0.0, 300 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken) << "not further into the obstacle";
  base.pass(kWheelsSecond_ns);
  base.drive(-0.2, 0.0, 500 * kWheelsMs_ns);
  EXPECT_TRUE(base.taken);
}

TEST(TextBaseDriver, ALowBatteryIsReported) {
  TextBaseOnLine base(text_settings(), {.battery_v = 10.2});
  ASSERT_TRUE(base.start());
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(TextBaseDriver, ThePoseGoesOnWhenTheBaseRestarts) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, 3 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  base.emulator.switch_on(base.line.now_ns());
  base.pass(3 * kWheelsSecond_ns);
  ASSERT_TRUE(base.driver.status().commands_taken) << base.driver.status().reason;
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  base.expect_pose(0.03);
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
  for (const auto& change : std::vector<std::function<void(BaseSettings&)>>{
           [](BaseSettings& s) { s.text.ticks_per_m = 0.0; },
           [](BaseSettings& s) { s.text.track_m = 20.0; },
           [](BaseSettings& s) { s.watchdog_s = 0.0; }}) {
    BaseSettings settings = text_settings();
    change(settings);
    EXPECT_THROW(TextBaseDriver{settings}, std::invalid_argument);
  }
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
