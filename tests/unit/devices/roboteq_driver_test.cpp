// The driver of a Roboteq controller against its emulator.
#include "topogeo/devices/roboteq_driver.hpp"

#include <functional>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/roboteq_emulator.hpp"

#include "two_wheels_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::RoboteqEmulatorSettings;
using testing::HasSubstr;

BaseSettings roboteq_settings() {
  BaseSettings settings;
  settings.line.baud = 115'200;
  settings.battery_low_v = 22.0;
  return settings;
}

struct RoboteqOnLine : TwoWheelsOnLine<RoboteqDriver, simulation::RoboteqEmulator> {
  explicit RoboteqOnLine(const BaseSettings& settings = roboteq_settings(),
                         const RoboteqEmulatorSettings& base = {})
      : TwoWheelsOnLine(settings, base) {}
};

TEST(RoboteqDriver, DrivesASquareAndKnowsWhereItIs) {
  RoboteqOnLine base;
  drive_a_square(base, 24.6);
  EXPECT_EQ(base.emulator.watchdog_ms(), 300) << "base.watchdog_s";
}

TEST(RoboteqDriver, MotorsAreWhereTheSettingsSay) {
  BaseSettings settings = roboteq_settings();
  settings.roboteq.left_channel = 2;
  settings.roboteq.right_reversed = true;
  settings.roboteq.full_rpm = 2000.0;
  RoboteqOnLine base(settings, {.wheels = settings.roboteq});
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.3, 3 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.truth.theta_rad, 0.6);
  EXPECT_GT(base.truth.position_m().norm(), 0.6);
  base.expect_pose(0.02);
}

TEST(RoboteqDriver, AControllerThatKeepsItsOwnWatchdogIsNotDriven) {
  RoboteqOnLine base(roboteq_settings(), {.takes_watchdog = false});
  EXPECT_FALSE(base.start());
  EXPECT_EQ(base.driver.status().state, BaseState::kOffline);
}

struct RoboteqSign {
  const char* name;
  std::function<void(simulation::RoboteqEmulator&, bool)> set;
  const char* reason;
};

class RoboteqSigns : public testing::TestWithParam<RoboteqSign> {};

TEST_P(RoboteqSigns, HoldLikeAnEmergencyStopUntilAReset) {
  RoboteqOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  GetParam().set(base.emulator, true);
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_THAT(base.driver.status().reason, HasSubstr(GetParam().reason));
  base.driver.reset_stop(base.line.now_ns());
  base.pass(500 * kWheelsMs_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop) << "the reason goes on";
  GetParam().set(base.emulator, false);
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  expect_reset_before_motion(base);
}

const std::vector<RoboteqSign> kRoboteqSigns{
    {"EmergencyStop",
     [](auto& roboteq, bool on) {
       on ? roboteq.press_emergency_stop() : roboteq.release_emergency_stop();
     },
     ""},
    {"Fault", [](auto& roboteq, bool on) { roboteq.overheat(on); }, "reports a fault"}};

INSTANTIATE_TEST_SUITE_P(All, RoboteqSigns, testing::ValuesIn(kRoboteqSigns),
                         [](const auto& sign) { return std::string(sign.param.name); });

// The watchdog stops the motors, which would go on with the first command.
TEST(RoboteqDriver, NothingRevivesTheMotorsAfterTheWatchdog) {
  RoboteqOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.line.unplug();
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.fastest_mps = 0.0;
  base.line.plug_in();
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.fastest_mps, 0.0);
  EXPECT_TRUE(base.driver.status().commands_taken);
  base.expect_pose(0.02);
}

TEST(RoboteqDriver, ALowBatteryIsReported) {
  RoboteqOnLine base(roboteq_settings(), {.battery_v = 21.0});
  ASSERT_TRUE(base.start());
  base.pass(kWheelsSecond_ns);
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(RoboteqDriver, ThePoseGoesOnWhenTheControllerRestarts) {
  RoboteqOnLine base;
  restart_on_the_way(base, 3 * kWheelsSecond_ns);
  EXPECT_EQ(base.emulator.watchdog_ms(), 300);
}

TEST(RoboteqDriver, RefusesSettingsOutOfRange) {
  expect_settings_refused<RoboteqDriver>(
      roboteq_settings(), {[](BaseSettings& s) { s.roboteq.ticks_per_m = 0.0; },
                           [](BaseSettings& s) { s.roboteq.track_m = 20.0; },
                           [](BaseSettings& s) { s.roboteq.full_rpm = -1.0; },
                           [](BaseSettings& s) { s.roboteq.left_channel = 3; },
                           [](BaseSettings& s) { s.roboteq.motor_turns_per_m = 0.0; }});
}

class RoboteqFaults : public testing::TestWithParam<TwoWheelFault<RoboteqOnLine>> {};

TEST_P(RoboteqFaults, AThousandTimes) {
  RoboteqOnLine base;
  strike_a_thousand_times(base, GetParam(), 0.04);  // 60 ms from answer to answer, a damaged digit
}

INSTANTIATE_TEST_SUITE_P(All, RoboteqFaults, testing::ValuesIn(two_wheel_faults<RoboteqOnLine>()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
