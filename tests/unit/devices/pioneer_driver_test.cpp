// The driver of a Pioneer against its emulator.
#include "topogeo/devices/pioneer_driver.hpp"

#include <functional>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/pioneer_emulator.hpp"

#include "two_wheels_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::PioneerEmulatorSettings;
using testing::HasSubstr;
using testing::IsEmpty;

BaseSettings pioneer_settings() {
  BaseSettings settings;
  settings.battery_low_v = 11.75;
  return settings;
}

struct PioneerOnLine : TwoWheelsOnLine<PioneerDriver, simulation::PioneerEmulator> {
  explicit PioneerOnLine(const BaseSettings& settings = pioneer_settings(),
                         const PioneerEmulatorSettings& base = {})
      : TwoWheelsOnLine(settings, base) {}
};

TEST(PioneerDriver, DrivesASquareAndKnowsWhereItIs) {
  PioneerOnLine base;
  drive_a_square(base, 12.6);
}

TEST(PioneerDriver, CoordinatesWrapManyTimes) {
  PioneerOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.45, 0.0, 160 * kWheelsSecond_ns);  // 72 m; they wrap after 33 m
  base.drive(0.0, 0.0, 2 * kWheelsSecond_ns);
  EXPECT_GT(base.truth.x_m, 70.0);
  base.expect_pose(0.02);
}

TEST(PioneerDriver, UnitsAreThoseOfTheSettings) {
  BaseSettings settings = pioneer_settings();
  settings.pioneer.units_per_m = 2061.0;  // of a Pioneer 2
  PioneerOnLine base(settings, {.units = settings.pioneer});
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.2, 5 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, 2 * kWheelsSecond_ns);
  EXPECT_GT(base.truth.position_m().norm(), 0.8);
  base.expect_pose(0.02);
}

struct PioneerSign {
  const char* name;
  std::function<void(simulation::PioneerEmulator&, bool)> set;
  const char* reason;
};

class PioneerSigns : public testing::TestWithParam<PioneerSign> {};

TEST_P(PioneerSigns, HoldLikeAnEmergencyStopUntilAReset) {
  PioneerOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  GetParam().set(base.emulator, true);
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_THAT(base.driver.status().reason, HasSubstr(GetParam().reason));
  EXPECT_TRUE(base.driver.held_stops().emergency_stop);
  GetParam().set(base.emulator, false);
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  expect_reset_before_motion(base);
}

const std::vector<PioneerSign> kPioneerSigns{
    {"StopButton",
     [](auto& pioneer, bool on) {
       on ? pioneer.press_emergency_stop() : pioneer.release_emergency_stop();
     },
     ""},
    {"MotorsSwitchedOff",
     [](auto& pioneer, bool on) {
       if (on) pioneer.switch_motors_off();
     },
     "motors were switched off"},
    {"Stall", [](auto& pioneer, bool on) { pioneer.block_wheel(on); }, "a wheel is blocked"}};

INSTANTIATE_TEST_SUITE_P(All, PioneerSigns, testing::ValuesIn(kPioneerSigns),
                         [](const auto& sign) { return std::string(sign.param.name); });

TEST(PioneerDriver, ABumperStopsTheBaseAndLetsItBackOff) {
  PioneerOnLine base;
  back_off_from_a_bump(base, 1U << 9U);  // the third of the second group
}

// The server stops the robot after two seconds, and would drive on with the first command.
TEST(PioneerDriver, TheServersWatchdogStopsItAndNothingRevivesIt) {
  PioneerOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.line.unplug();
  base.pass(1500 * kWheelsMs_ns);
  EXPECT_GT(base.speed_mps(), 0.2) << "until its watchdog expires";
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.line.plug_in();
  base.fastest_mps = 0.0;
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_LT(base.fastest_mps, 0.02);
  EXPECT_TRUE(base.driver.status().commands_taken);
  base.expect_pose(0.02);
}

TEST(PioneerDriver, StopBytesStopEvenBehindAnOrderThatWasCut) {
  PioneerOnLine base;
  ASSERT_TRUE(base.start());
  const std::vector<std::uint8_t> order = to_bytes(PioneerOrder{pioneer_command::kSpeed, 300});
  for (std::size_t size = 0; size <= order.size(); ++size) {
    base.drive(0.3, 0.0, kWheelsSecond_ns);
    base.line.freeze_host(true);
    base.emulator.receive(std::span(order).first(size), base.host, base.line.now_ns());
    base.emulator.receive(base.driver.stop_bytes(), base.host, base.line.now_ns());
    base.pass(kWheelsSecond_ns);
    EXPECT_EQ(base.speed_mps(), 0.0) << size;
    base.line.freeze_host(false);
    base.pass(kWheelsSecond_ns);
  }
}

class PioneerLosses : public testing::TestWithParam<int> {};

TEST_P(PioneerLosses, AreMadeUpFor) {
  PioneerOnLine base;
  base.emulator.lose(static_cast<std::uint8_t>(GetParam()), 2);
  ASSERT_TRUE(base.start()) << base.driver.status().reason;
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_EQ(base.emulator.deceleration_mmps2(), 500) << "that of the settings";
}

INSTANTIATE_TEST_SUITE_P(All, PioneerLosses, testing::Values(0, 1, 2, 4, 5));

TEST(PioneerDriver, SonarsOfARingAreDeliveredTogether) {
  BaseSettings settings = pioneer_settings();
  settings.pioneer.sonars = true;
  PioneerOnLine base(settings);
  base.emulator.set_sonar(2, 1500);
  BodySensors& sonars = *base.driver.sonars();
  EXPECT_FALSE(sonars.read(base.line.now_ns()));
  EXPECT_THAT(sonars.fault(), HasSubstr("not reported its sonars"));
  ASSERT_TRUE(base.start());
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_TRUE(base.emulator.sonars_fire());
  const auto readings = sonars.read(base.line.now_ns());
  ASSERT_TRUE(readings) << sonars.fault();
  ASSERT_EQ(readings->sonar_m.size(), 8U);
  EXPECT_EQ(readings->sonar_m[2], 1.5F);
  EXPECT_EQ(readings->sonar_m[3], 0.0F) << "no echo";
  EXPECT_THAT(sonars.fault(), IsEmpty());
  EXPECT_EQ(base.driver.sonar_mounts().size(), 16U);
  base.line.unplug();
  base.pass(1500 * kWheelsMs_ns);
  EXPECT_FALSE(sonars.read(base.line.now_ns())) << "old ranges do not show free space";
  EXPECT_THAT(sonars.fault(), HasSubstr("sonar 0"));
}

TEST(PioneerDriver, SonarsAreSilentUnlessTheyAreWanted) {
  PioneerOnLine base;
  ASSERT_TRUE(base.start());
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_FALSE(base.emulator.sonars_fire());
}

TEST(PioneerDriver, ALowBatteryIsReported) {
  PioneerOnLine base(pioneer_settings(), {.battery_v = 11.2});
  ASSERT_TRUE(base.start());
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(PioneerDriver, ThePoseGoesOnWhenTheBaseRestarts) {
  PioneerOnLine base;
  restart_on_the_way(base, 5 * kWheelsSecond_ns);
}

TEST(PioneerDriver, RefusesSettingsOutOfRange) {
  expect_settings_refused<PioneerDriver>(
      pioneer_settings(), {[](BaseSettings& s) { s.pioneer.units_per_m = 0.0; },
                           [](BaseSettings& s) { s.pioneer.units_per_turn = -1.0; },
                           [](BaseSettings& s) { s.pioneer.sonar_units_per_m = 1e9; }});
}

class PioneerFaults : public testing::TestWithParam<TwoWheelFault<PioneerOnLine>> {};

TEST_P(PioneerFaults, AThousandTimes) {
  PioneerOnLine base;
  strike_a_thousand_times(base, GetParam(), 0.06);  // 100 ms between reports, 50 ms on the line
}

INSTANTIATE_TEST_SUITE_P(All, PioneerFaults, testing::ValuesIn(two_wheel_faults<PioneerOnLine>()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
