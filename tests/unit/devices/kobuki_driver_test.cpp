// The driver of a Kobuki against its emulator.
#include "topogeo/devices/kobuki_driver.hpp"

#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/kobuki_emulator.hpp"

#include "two_wheels_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::KobukiEmulatorSettings;
using testing::HasSubstr;

BaseSettings kobuki_settings() {
  BaseSettings settings;
  settings.line.baud = 115'200;
  settings.battery_low_v = 14.0;
  return settings;
}

struct KobukiOnLine : TwoWheelsOnLine<KobukiDriver, simulation::KobukiEmulator> {
  explicit KobukiOnLine(const BaseSettings& settings = kobuki_settings(),
                        const KobukiEmulatorSettings& base = {})
      : TwoWheelsOnLine(settings, base) {}
};

TEST(KobukiDriver, DrivesASquareAndKnowsWhereItIs) {
  KobukiOnLine base;
  drive_a_square(base, 16.2);
}

TEST(KobukiDriver, CountsWrapManyTimes) {
  KobukiOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.45, 0.0, 90 * kWheelsSecond_ns);  // 40 m; counts wrap after 5.6 m, time after 66 s
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.truth.x_m, 35.0);
  base.expect_pose(0.02);
  EXPECT_EQ(base.driver.status().restarts, 0U);
}

TEST(KobukiDriver, TheHeadingFollowsTheGyro) {
  BaseSettings wide = kobuki_settings();
  wide.kobuki.track_m = 0.46;  // twice the true one: the wheels would show half the turn
  KobukiOnLine base(wide);
  ASSERT_TRUE(base.start());
  base.drive(0.0, 0.3, 4 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.truth.theta_rad, 1.0);
  EXPECT_NEAR(base.last.T_odom_robot.theta_rad, base.truth.theta_rad, 0.01);
}

struct KobukiSign {
  const char* name;
  void (simulation::KobukiEmulator::*set)(bool);
  const char* reason;
};

class KobukiSigns : public testing::TestWithParam<KobukiSign> {};

// The firmware goes on driving; the driver stops it and holds it.
TEST_P(KobukiSigns, HoldLikeAnEmergencyStopUntilAReset) {
  KobukiOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  (base.emulator.*GetParam().set)(true);
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_THAT(base.driver.status().reason, HasSubstr(GetParam().reason));
  EXPECT_TRUE(base.driver.held_stops().emergency_stop);
  base.driver.reset_stop(base.line.now_ns());
  base.pass(200 * kWheelsMs_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop) << "the reason goes on";
  (base.emulator.*GetParam().set)(false);
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  expect_reset_before_motion(base);
}

const std::vector<KobukiSign> kKobukiSigns{
    {"WheelDrop", &simulation::KobukiEmulator::hang_wheels, "a wheel hangs"},
    {"Cliff", &simulation::KobukiEmulator::set_cliff, "sees no floor"},
    {"Overcurrent", &simulation::KobukiEmulator::set_overcurrent, "too much current"}};

INSTANTIATE_TEST_SUITE_P(All, KobukiSigns, testing::ValuesIn(kKobukiSigns),
                         [](const auto& sign) { return std::string(sign.param.name); });

TEST(KobukiDriver, ARobotOnTheCableOfItsChargerWaits) {
  KobukiOnLine base;
  base.emulator.set_cable(true);
  EXPECT_FALSE(base.start());
  EXPECT_EQ(base.driver.status().state, BaseState::kStarting);
  EXPECT_THAT(base.driver.status().reason, HasSubstr("cable"));
  base.emulator.set_cable(false);
  EXPECT_TRUE(base.wait_for_commands());
}

TEST(KobukiDriver, AFastCommandIsSlowerOnTheSameArc) {
  KobukiOnLine base;
  keep_the_arc_of_fast_commands(base);
}

TEST(KobukiDriver, ABumperStopsTheBaseAndLetsItBackOff) {
  KobukiOnLine base;
  back_off_from_a_bump(base, 2U);  // the central one
}

TEST(KobukiDriver, ABaseThatRunsOnFromAKilledProgramIsStoppedFirst) {
  KobukiOnLine base;
  run_on_from_a_killed_program(base);
}

TEST(KobukiDriver, ALowBatteryIsReported) {
  KobukiOnLine base(kobuki_settings(), {.battery_v = 13.5});
  ASSERT_TRUE(base.start());
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(KobukiDriver, ThePoseGoesOnWhenTheBaseRestarts) {
  KobukiOnLine base;
  restart_on_the_way(base, 4 * kWheelsSecond_ns);
  EXPECT_EQ(base.driver.status().restarts, 1U);
}

TEST(KobukiDriver, RefusesSettingsOutOfRange) {
  expect_settings_refused<KobukiDriver>(
      kobuki_settings(),
      {[](BaseSettings& s) { s.kobuki.ticks_per_m = 0.0; },
       [](BaseSettings& s) { s.kobuki.track_m = 20.0; }, [](BaseSettings& s) { s.line.baud = 0; }});
}

class KobukiFaults : public testing::TestWithParam<TwoWheelFault<KobukiOnLine>> {};

TEST_P(KobukiFaults, AThousandTimes) {
  KobukiOnLine base;
  strike_a_thousand_times(base, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, KobukiFaults, testing::ValuesIn(two_wheel_faults<KobukiOnLine>()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
