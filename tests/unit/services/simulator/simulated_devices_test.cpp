// The devices on their ports, on the test's own clock.
#include "simulator/simulated_devices.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "services/simulator/host_port.hpp"
#include "simulator/fault_injector.hpp"

namespace topogeo::simulator {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
// The base ignores commands in its first two seconds.
constexpr std::int64_t kReady_ns = 3 * kSecond_ns;
constexpr const char* kCorridor =
    "walls: [{from: [0, -1], to: [20, -1]}, {from: [0, 1], to: [20, 1]}]\n"
    "tour: [[1, 0], [18, 0]]\n";
// 10 cm/s of a B21, forward.
constexpr std::string_view kDrive = "TV afc\rT+\r";

class SimulatedDevicesTest : public testing::Test {
 protected:
  static DeviceOptions options() {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    DeviceOptions options;
    options.laser_port = link_name(name + "-laser");
    options.base_port = link_name(name + "-base");
    return options;
  }
  void run_for(double seconds) {
    devices_.run_until(devices_.now_ns() +
                       static_cast<std::int64_t>(seconds * static_cast<double>(kSecond_ns)));
  }
  void run_with_faults(double seconds) {
    for (double done_s = 0.0; done_s < seconds; done_s += 0.01) {
      run_for(0.01);
      faults_.tick();
    }
  }
  double path_m() { return devices_.robot().path_m(); }

  SimulatedDevices devices_{world::parse_world(kCorridor, "w"), options()};
  FaultInjector faults_{devices_};
  HostPort laser_{options().laser_port};
  HostPort base_{options().base_port};
};

TEST_F(SimulatedDevicesTest, TheBaseDrivesTheRobotAndReportsIt) {
  devices_.run_until(kReady_ns);
  base_.write("HD\rSD 32\rSP 40\r");  // clock, x and y; four reports a second
  base_.write(kDrive);
  run_for(5.0);
  EXPECT_NEAR(path_m(), 0.5, 0.05);
  EXPECT_THAT(base_.read(), HasSubstr("BPY 80"));
  base_.write("TH\r");
  run_for(3.0);
  const double stopped_m = path_m();
  run_for(1.0);
  EXPECT_EQ(path_m(), stopped_m);
}

TEST_F(SimulatedDevicesTest, WhereTheWorldStandsStillTheClockOfTheBaseGoesOn) {
  devices_.run_until(kReady_ns);
  base_.write("HD\r");
  base_.write(kDrive);
  run_for(2.0);
  const double driven_m = path_m();
  static_cast<void>(base_.read());
  devices_.stand_still(2 * kSecond_ns);
  EXPECT_EQ(path_m(), driven_m);
  EXPECT_EQ(devices_.now_ns(), kReady_ns + 4 * kSecond_ns);
  base_.write("CL\r");  // 7 s since it was switched on, in 1/256 s
  run_for(0.02);
  EXPECT_THAT(base_.read(), HasSubstr("CL 7"));
  EXPECT_GT(path_m(), driven_m) << "and then it drives on";
}

TEST_F(SimulatedDevicesTest, WhereTheWorldStandsStillTheWatchdogOfTheBaseWaits) {
  devices_.run_until(kReady_ns);
  base_.write("HD\rWD 4c\r");  // 0.3 s
  base_.write(kDrive);
  run_for(0.1);
  devices_.stand_still(2 * kSecond_ns);
  base_.write("WD 4c\r");  // its host has sent it meanwhile
  run_for(0.25);
  EXPECT_THAT(base_.read(), Not(HasSubstr("WDT")));
  run_for(0.1);
  EXPECT_THAT(base_.read(), HasSubstr("WDT"));
}

TEST_F(SimulatedDevicesTest, AtAnotherRateNothingIsUnderstood) {
  devices_.run_until(kReady_ns);
  base_.set_rate(B38400);
  base_.write(kDrive);
  run_for(2.0);
  EXPECT_EQ(path_m(), 0.0);
}

TEST_F(SimulatedDevicesTest, TheLaserAnswers) {
  run_for(0.1);
  laser_.write(std::string_view("\x02\x00\x02\x00\x30\x01\x31\x18", 8));  // a scan, please
  run_for(2.0);
  const std::string answer = laser_.read();
  // ACK and the header of 361 measured values.
  EXPECT_THAT(answer, StartsWith(std::string("\x06\x02\x80\xd6\x02\xb0\x69\x01", 8)));
  EXPECT_EQ(answer.size(), 733U);
}

TEST_F(SimulatedDevicesTest, AWallPressesABumper) {
  devices_.robot().carry({10.0, 0.5, std::numbers::pi / 2.0});
  devices_.run_until(kReady_ns);
  base_.write("HD\rSD a\rSP 40\rBE 0\r");  // clock and bumpers
  base_.write(kDrive);
  run_for(5.0);
  EXPECT_GE(devices_.robot().collisions(), 1U);
  EXPECT_THAT(base_.read(), HasSubstr("BBS "));
  EXPECT_NEAR(devices_.robot().T_world_robot().y_m, 1.0 - 0.267, 1e-3);
}

TEST_F(SimulatedDevicesTest, AnUnpluggedPortComesBack) {
  faults_.begin({.kind = msg::kSimulatedUnplug, .device = Device::kLaser, .duration_s = 0.5});
  EXPECT_TRUE(laser_.hung_up());
  EXPECT_FALSE(base_.hung_up());
  run_with_faults(0.4);
  EXPECT_FALSE(devices_.port(Device::kLaser).plugged());
  run_with_faults(0.2);
  EXPECT_TRUE(devices_.port(Device::kLaser).plugged());
  EXPECT_EQ(faults_.active(), 0U);
}

TEST_F(SimulatedDevicesTest, TheJoystickDrivesAndTheEmergencyStopHolds) {
  devices_.run_until(kReady_ns);
  faults_.begin({.kind = msg::kSimulatedJoystick,
                 .device = Device::kBase,
                 .duration_s = 2.0,
                 .velocity = {0.3, 0.0}});
  run_with_faults(2.5);
  const double by_hand_m = path_m();
  EXPECT_GT(by_hand_m, 0.3);
  run_with_faults(1.0);
  EXPECT_NEAR(path_m(), by_hand_m, 0.02);

  base_.write(kDrive);
  run_with_faults(2.0);
  faults_.begin({.kind = msg::kSimulatedEmergencyStop, .device = Device::kBase, .duration_s = 1.0});
  run_with_faults(0.5);
  const double held_m = path_m();
  run_with_faults(0.4);
  EXPECT_NEAR(path_m(), held_m, 0.005);
}

TEST_F(SimulatedDevicesTest, ASilentBaseSaysNothingUntilItsTimeIsOver) {
  devices_.run_until(kReady_ns);
  base_.write("HD\rSD 32\rSP 40\r");
  run_for(1.0);
  EXPECT_NE(base_.read(), "");
  const Fault silence{.kind = msg::kSimulatedSilence, .device = Device::kBase, .duration_s = 1.0};
  faults_.begin(silence);
  run_with_faults(0.3);
  static_cast<void>(base_.read());
  faults_.begin(silence);  // again: for longer
  run_with_faults(0.9);
  EXPECT_EQ(base_.read(), "");
  EXPECT_EQ(faults_.active(), 1U);
  run_with_faults(1.0);
  EXPECT_NE(base_.read(), "");
}

TEST_F(SimulatedDevicesTest, ABaseWithoutPowerStandsAndComesBackAsNew) {
  devices_.run_until(kReady_ns);
  base_.write("HD\rSD 32\rSP 40\r");
  base_.write(kDrive);
  run_for(2.0);
  faults_.begin({.kind = msg::kSimulatedRestart, .device = Device::kBase, .duration_s = 2.0});
  const double off_m = path_m();
  run_with_faults(0.1);
  static_cast<void>(base_.read());
  base_.write(kDrive);
  run_with_faults(1.5);
  EXPECT_EQ(base_.read(), "");
  EXPECT_EQ(path_m(), off_m);

  run_with_faults(3.0);  // power on again, and the start-up time
  EXPECT_EQ(base_.read(), "");
  base_.write("TW\r");
  run_for(0.5);
  EXPECT_EQ(base_.read(), "TW\r\nTW 0\r\n");  // it echoes and has counted nothing
}

TEST(BumperBits, AreOneOfSixteenCounterClockwiseFromAhead) {
  constexpr double kSector_rad = std::numbers::pi / 8.0;
  for (unsigned i = 0; i < 16; ++i) {
    double direction_rad = (i + 0.5) * kSector_rad;
    if (direction_rad > std::numbers::pi) direction_rad -= 2.0 * std::numbers::pi;
    EXPECT_EQ(bumper_bits(direction_rad), 1U << i);
  }
  EXPECT_EQ(bumper_bits(std::numbers::pi), 1U << 8U);
}

TEST(FaultFromMsg, RefusesWhatMakesNoSense) {
  msg::SimulatorCommand command;
  command.fault(msg::kSimulatedEcho);
  command.device(msg::kSimulatedLaser);
  command.duration_s(2.0);
  EXPECT_EQ(fault_from_msg(command).device, Device::kBase);  // only the base has this fault
  EXPECT_EQ(describe(fault_from_msg(command)), "echo of the base for 2 s");
  command.duration_s(0.0);
  EXPECT_THROW(fault_from_msg(command), std::invalid_argument);
  command.duration_s(std::nan(""));
  EXPECT_THROW(fault_from_msg(command), std::invalid_argument);
  command.duration_s(1.0);
  command.linear_mps(9.0);
  EXPECT_THROW(fault_from_msg(command), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::simulator
