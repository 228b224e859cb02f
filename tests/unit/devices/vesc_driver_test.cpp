// The driver of a pair of VESC controllers against its emulator.
#include "topogeo/devices/vesc_driver.hpp"

#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/vesc_emulator.hpp"

#include "two_wheels_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::VescEmulatorSettings;
using testing::HasSubstr;

BaseSettings vesc_settings() {
  BaseSettings settings;
  settings.line.baud = 115'200;
  settings.battery_low_v = 22.0;
  return settings;
}

struct VescOnLine : TwoWheelsOnLine<VescDriver, simulation::VescEmulator> {
  explicit VescOnLine(const BaseSettings& settings = vesc_settings(),
                      const VescEmulatorSettings& base = {})
      : TwoWheelsOnLine(settings, base) {}
};

TEST(VescDriver, DrivesASquareAndKnowsWhereItIs) {
  VescOnLine base;
  drive_a_square(base, 24.6);
}

TEST(VescDriver, MotorsAreWhereTheSettingsSay) {
  BaseSettings settings = vesc_settings();
  settings.vesc.can_id = 77;
  settings.vesc.port_is_right = true;
  settings.vesc.right_reversed = true;
  VescOnLine base(settings, {.wheels = settings.vesc});
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.3, 3 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.truth.theta_rad, 0.6);
  EXPECT_GT(base.truth.position_m().norm(), 0.6);
  base.expect_pose(0.02);
}

TEST(VescDriver, AFaultHoldsLikeAnEmergencyStopUntilAReset) {
  VescOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.emulator.set_fault_code(2);
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_THAT(base.driver.status().reason, HasSubstr("reports a fault"));
  base.driver.reset_stop(base.line.now_ns());
  base.pass(500 * kWheelsMs_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop) << "the fault goes on";
  base.emulator.set_fault_code(0);
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  expect_reset_before_motion(base);
}

// One wheel alone would turn the robot.
TEST(VescDriver, StopsWhenAControllerLeavesTheBus) {
  VescOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.emulator.cut_can_bus(true);
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.driver.status().state, BaseState::kOffline);
  EXPECT_EQ(base.emulator.commanded_velocity().angular_rad_per_s, 0.0);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.emulator.cut_can_bus(false);
  ASSERT_TRUE(base.wait_for_commands());
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  base.expect_pose(0.05);  // its path while it was silent is not known
}

TEST(VescDriver, TheTimeoutOfTheControllersStopsItAndNothingRevivesIt) {
  VescOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.line.unplug();
  base.pass(700 * kWheelsMs_ns);
  EXPECT_GT(base.speed_mps(), 0.2) << "until their timeout";
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.fastest_mps = 0.0;
  base.line.plug_in();
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.fastest_mps, 0.0);
  EXPECT_TRUE(base.driver.status().commands_taken);
  base.expect_pose(0.02);
}

TEST(VescDriver, StopBytesStopEvenBehindAnOrderThatWasCut) {
  VescOnLine base;
  ASSERT_TRUE(base.start());
  const std::vector<std::uint8_t> order = to_bytes(vesc_set_rpm(1000));
  for (std::size_t size = 0; size <= order.size(); ++size) {
    base.drive(0.3, 0.0, kWheelsSecond_ns);
    base.line.freeze_host(true);
    base.emulator.receive(std::span(order).first(size), base.host, base.line.now_ns());
    base.emulator.receive(base.driver.stop_bytes(), base.host, base.line.now_ns());
    base.pass(500 * kWheelsMs_ns);  // shorter than their timeout
    EXPECT_EQ(base.speed_mps(), 0.0) << size;
    base.line.freeze_host(false);
    base.pass(kWheelsSecond_ns);
  }
}

TEST(VescDriver, ALowBatteryIsReported) {
  VescOnLine base(vesc_settings(), {.battery_v = 21.0});
  ASSERT_TRUE(base.start());
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(VescDriver, ThePoseGoesOnWhenTheControllersRestart) {
  VescOnLine base;
  restart_on_the_way(base, 3 * kWheelsSecond_ns);
}

TEST(VescDriver, RefusesSettingsOutOfRange) {
  expect_settings_refused<VescDriver>(vesc_settings(),
                                      {[](BaseSettings& s) { s.vesc.pole_pairs = 0; },
                                       [](BaseSettings& s) { s.vesc.motor_turns_per_m = 0.0; },
                                       [](BaseSettings& s) { s.vesc.track_m = 20.0; },
                                       [](BaseSettings& s) { s.vesc.can_id = 254; }});
}

class VescFaults : public testing::TestWithParam<TwoWheelFault<VescOnLine>> {};

TEST_P(VescFaults, AThousandTimes) {
  VescOnLine base;
  strike_a_thousand_times(base, GetParam(), 0.03);  // 60 ms from answer to answer
}

INSTANTIATE_TEST_SUITE_P(All, VescFaults, testing::ValuesIn(two_wheel_faults<VescOnLine>()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
