// The driver of SICK safety scanners: start, scans with their times, fields, health, faults.
#include "topogeo/devices/safety_driver.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/simulation/safety_emulator.hpp"

#include "turning_laser_faults.hpp"
#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kSafetySecond_ns = 1'000'000'000;

simulation::SafetyEmulatorSettings a_microscan3() {
  simulation::SafetyEmulatorSettings laser;
  laser.line.baud = 30'000'000;  // a network
  laser.beams = 705;
  laser.turns_hz = 25.0;
  return laser;
}

struct SafetyOnLine : TurningLaserOnLine<SafetyDriver, simulation::SafetyEmulator> {
  explicit SafetyOnLine(const simulation::SafetyEmulatorSettings& laser = a_microscan3(),
                        const TurningLaserSettings& turning = {},
                        const SafetySettings& settings = {})
      : TurningLaserOnLine(laser, laser_model("sick_microscan3"), turning, settings) {}
  double slowest_hz = 24.0;
  double fastest_hz = 26.0;
};

std::uint64_t dropped(const SafetyOnLine& laser, std::string_view reason) {
  for (const auto& [name, count] : laser.driver.health().drops) {
    if (name == reason) return count;
  }
  ADD_FAILURE() << "no drop is named " << reason;
  return 0;
}

void pass_host(SafetyOnLine& laser, std::string_view text) {
  std::vector<std::uint8_t> bytes;
  put_envelope(bytes, EnvelopeKind::kHost, std::vector<std::uint8_t>(text.begin(), text.end()));
  laser.driver.receive(bytes, laser.line.now_ns());
}

TEST(SafetyDriver, DeliversEveryScanAtItsTime) {
  SafetyOnLine laser;
  EXPECT_EQ(laser.driver.health().state, LaserState::kOffline);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(60, 8 * kSafetySecond_ns)) << laser.driver.health().reason;
  EXPECT_EQ(laser.wrong_scans, 0U);
  const LaserHealth health = laser.driver.health();
  EXPECT_EQ(health.state, LaserState::kRunning);
  EXPECT_EQ(health.fault, "");
  EXPECT_EQ(health.device, "SICK microScan3, serial number 20210001");
  EXPECT_NEAR(health.turns_hz, 25.0, 1e-9);
  const LaserScan& scan = laser.scans.back();
  ASSERT_EQ(scan.ranges_m.size(), 705U);
  EXPECT_NEAR(scan.angle_min_rad, -275.0 / 360.0 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(scan.time_step_s, 0.04 * 275.0 / 704.0 / 360.0, 1e-9);
  EXPECT_FALSE(scan.protective_field || scan.warning_field);
  EXPECT_LE(laser.emulator.scans_sent() - laser.scans.size(), 1U);
}

TEST(SafetyDriver, AsksForDataToTheAddressOfThePort) {
  SafetyOnLine laser(a_microscan3(), {}, {.channel = 2});
  laser.line.plug_in();
  pass_host(laser, "192.168.0.7:6060");
  ASSERT_TRUE(laser.run_for_scans(1, 8 * kSafetySecond_ns));
  EXPECT_EQ(laser.emulator.output().address, 0xC0A80007U);
  EXPECT_EQ(laser.emulator.output().port, 6060);
  EXPECT_EQ(laser.emulator.output().channel, 2);
  EXPECT_EQ(laser.emulator.output().interface, 4);
}

TEST(SafetyDriver, TheDayOfTheLaserEnds) {
  simulation::SafetyEmulatorSettings emulated = a_microscan3();
  emulated.clock_ms = 86'400'000 - 1000;
  SafetyOnLine laser(emulated);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(60, 8 * kSafetySecond_ns));
  EXPECT_EQ(laser.wrong_scans, 0U);
  for (std::size_t i = 1; i < laser.scans.size(); ++i) {
    const std::int64_t apart_ns = laser.scans[i].stamp_ns - laser.scans[i - 1].stamp_ns;
    EXPECT_NEAR(static_cast<double>(apart_ns), 40e6, 2e6);
  }
}

TEST(SafetyDriver, FieldsOfThePathsAreReported) {
  for (const bool warning : {false, true}) {
    simulation::SafetyEmulatorSettings emulated = a_microscan3();
    (warning ? emulated.warning_field_m : emulated.protective_field_m) = 9.0;
    SafetyOnLine laser(emulated, {}, {.protective_path = 1, .warning_path = 2});
    laser.line.plug_in();
    ASSERT_TRUE(laser.run_for_scans(3, 8 * kSafetySecond_ns));
    EXPECT_EQ(laser.scans.back().protective_field, !warning);
    EXPECT_EQ(laser.scans.back().warning_field, warning);
  }
}

TEST(SafetyDriver, AFieldThatCountsAsNothingIsNotReported) {
  simulation::SafetyEmulatorSettings emulated = a_microscan3();
  emulated.protective_field_m = 9.0;
  SafetyOnLine laser(emulated, {}, {.protective_path = 0});
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 8 * kSafetySecond_ns));
  EXPECT_FALSE(laser.scans.back().protective_field);
}

TEST(SafetyDriver, ContaminationAndErrorsAreReported) {
  SafetyOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 8 * kSafetySecond_ns));
  laser.emulator.set_contaminated(true);
  ASSERT_TRUE(laser.run_for_scans(3, kSafetySecond_ns));
  EXPECT_TRUE(laser.driver.health().contaminated);
  EXPECT_EQ(laser.driver.health().error_level, 2);
  EXPECT_EQ(laser.driver.health().fault, "");
  EXPECT_TRUE(laser.scans.back().contaminated);
  laser.emulator.set_status({.contamination_error = true});
  ASSERT_TRUE(laser.run_for_scans(3, kSafetySecond_ns));
  EXPECT_EQ(laser.driver.health().fault, "the window is too dirty");
  laser.emulator.set_status({.device_error = true});
  ASSERT_TRUE(laser.run_for_scans(3, kSafetySecond_ns));
  EXPECT_EQ(laser.driver.health().fault, "the laser reports an error");
  EXPECT_EQ(laser.driver.health().error_level, 3);
}

TEST(SafetyDriver, UpsideDownBeamsAreMirrored) {
  SafetyOnLine upright;
  SafetyOnLine hanging(a_microscan3(), {.upside_down = true});
  for (SafetyOnLine* laser : {&upright, &hanging}) {
    laser->line.plug_in();
    ASSERT_TRUE(laser->run_for_scans(1, 8 * kSafetySecond_ns));
  }
  std::vector<float> mirrored = hanging.scans.front().ranges_m;
  std::ranges::reverse(mirrored);
  EXPECT_EQ(mirrored, upright.scans.front().ranges_m);
}

TEST(SafetyDriver, DataOfAnotherChannelAreDropped) {
  SafetyOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 8 * kSafetySecond_ns));
  laser.emulator.set_channel(3);
  laser.run_for(kSafetySecond_ns / 2);
  laser.scans.clear();
  laser.run_for(kSafetySecond_ns / 4);
  EXPECT_TRUE(laser.scans.empty());
  EXPECT_GT(dropped(laser, "data of another channel"), 10U);
}

TEST(SafetyDriver, ALaserWithOtherBeamsIsNamed) {
  simulation::SafetyEmulatorSettings emulated = a_microscan3();
  emulated.beams = 541;
  SafetyOnLine laser(emulated);
  laser.line.plug_in();
  laser.run_for(3 * kSafetySecond_ns);
  EXPECT_TRUE(laser.scans.empty());
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_EQ(laser.driver.health().reason,
            "it sends 541 beams, expected 705 of a SICK microScan3 (laser.model, laser.beams, or "
            "the settings of the laser)");
}

TEST(SafetyDriver, ARefusalIsNamed) {
  SafetyOnLine laser;
  laser.emulator.set_refusing(true);
  laser.line.plug_in();
  laser.run_for(kSafetySecond_ns);
  EXPECT_EQ(laser.driver.health().reason,
            "the laser refuses the data output: another program may be connected to it");
  laser.emulator.set_refusing(false);
  EXPECT_TRUE(laser.run_for_scans(1, 10 * kSafetySecond_ns));
}

TEST(SafetyDriver, NoLaserIsAFailureWithAReason) {
  SafetyOnLine laser;
  laser.emulator.switch_off();
  laser.line.plug_in();
  laser.run_for(20 * kSafetySecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_EQ(laser.driver.health().reason,
            "no data of a SICK microScan3: is it on, and may it send to this computer "
            "(laser.data_port)?");
  laser.emulator.switch_on(laser.line.now_ns());
  EXPECT_TRUE(laser.run_for_scans(1, 10 * kSafetySecond_ns));
}

TEST(SafetyDriver, SettingsOutOfRangeAreRefused) {
  const LaserModel& model = laser_model("sick_microscan3");
  EXPECT_THROW(SafetyDriver(model, {}, {.channel = 4}), std::invalid_argument);
  EXPECT_THROW(SafetyDriver(model, {}, {.protective_path = 21}), std::invalid_argument);
}

/// A datagram that is no data of a safety scanner.
std::vector<std::uint8_t> datagram_of_another(support::Random& random) {
  std::vector<std::uint8_t> contents(100);
  for (std::uint8_t& byte : contents) byte = static_cast<std::uint8_t>(random.below(256));
  std::vector<std::uint8_t> bytes;
  put_envelope(bytes, EnvelopeKind::kDatagram, contents);
  return bytes;
}

class SafetyFaults : public testing::TestWithParam<TurningLaserFault<SafetyOnLine>> {};

TEST_P(SafetyFaults, AThousandTimes) {
  simulation::SafetyEmulatorSettings emulated = a_microscan3();
  emulated.beams = 361;  // fewer take less time, and still two fragments
  SafetyOnLine laser(emulated, {.beams = 361});
  expect_no_wrong_scan(laser, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, SafetyFaults,
                         testing::ValuesIn(turning_laser_faults<SafetyOnLine>(
                             datagram_of_another, kSafetySecond_ns, 8 * kSafetySecond_ns)),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
