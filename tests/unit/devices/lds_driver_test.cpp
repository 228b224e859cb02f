#include "topogeo/devices/lds_driver.hpp"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/simulation/lds_emulator.hpp"

#include "turning_laser_faults.hpp"
#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::LdsEmulatorSettings;
using testing::HasSubstr;

constexpr std::int64_t kLdsSecond_ns = 1'000'000'000;

struct LdsOnLine : TurningLaserOnLine<LdsDriver, simulation::LdsEmulator> {
  explicit LdsOnLine(const char* model, const LdsEmulatorSettings& laser,
                     const LdsSettings& settings = {})
      : TurningLaserOnLine(laser, laser_model(model), TurningLaserSettings{}, settings) {
    // A motor that changes its speed during a turn of 0.2 s bends the angles over time.
    world.time_error_ns = 9'000'000;
  }
  double slowest_hz = 4.0;
  double fastest_hz = 5.5;
};

LdsEmulatorSettings an_xv11() {
  return {};
}

LdsEmulatorSettings an_lds01() {
  LdsEmulatorSettings laser;
  laser.format = kLds01;
  laser.line.baud = 230'400;
  laser.waits_for_letter = true;
  laser.range_max_m = 3.5;
  return laser;
}

void expect_every_turn(LdsOnLine& laser) {
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 3 * kLdsSecond_ns)) << laser.driver.health().reason;
  laser.run_for(20 * kLdsSecond_ns);
  EXPECT_GE(laser.scans.size(), 98U);
  EXPECT_EQ(laser.wrong_scans, 0U);
  for (const LaserScan& scan : laser.scans) ASSERT_EQ(scan.ranges_m.size(), 360U);
  const LaserHealth health = laser.driver.health();
  EXPECT_EQ(health.state, LaserState::kRunning);
  EXPECT_NEAR(health.turns_hz, 5.0, 0.2);
  for (const auto& [reason, count] : health.drops) {
    // The first tenth of a second gives no time.
    EXPECT_LE(count, reason == "packet without time" ? 60U : 1U) << reason;
  }
}

TEST(LdsDriver, EveryTurnOfAnXv11IsAScan) {
  LdsOnLine laser("xv11", an_xv11());
  expect_every_turn(laser);
}

TEST(LdsDriver, EveryTurnOfAnLds01IsAScan) {
  LdsOnLine laser("lds01", an_lds01());
  expect_every_turn(laser);
}

TEST(LdsDriver, StartsAndStopsTheMotorOfAnLds01) {
  LdsOnLine laser("lds01", an_lds01());
  EXPECT_FALSE(laser.emulator.turns());
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 3 * kLdsSecond_ns));
  EXPECT_TRUE(laser.emulator.turns());
  laser.driver.end(laser.line.now_ns());
  laser.run_for(kLdsSecond_ns / 10);
  EXPECT_FALSE(laser.emulator.turns());
  EXPECT_EQ(laser.driver.health().state, LaserState::kOffline);
}

TEST(LdsDriver, AsksAgainAfterSilence) {
  LdsOnLine laser("lds01", an_lds01());
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 3 * kLdsSecond_ns));
  laser.emulator.switch_off();
  laser.run_for(7 * kLdsSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  laser.emulator.switch_on(laser.line.now_ns());
  EXPECT_TRUE(laser.run_for_scans(1, 8 * kLdsSecond_ns));
  EXPECT_EQ(laser.driver.health().searches, 1U);
}

TEST(LdsDriver, ReportsChecksumsOfAnotherRule) {
  LdsEmulatorSettings other = an_lds01();
  other.wrong_checksums = true;
  LdsOnLine laser("lds01", other);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 4 * kLdsSecond_ns)) << laser.driver.health().reason;
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_THAT(laser.driver.health().reason, HasSubstr("not checked"));
  LdsOnLine strict("lds01", other, {LdsChecksum::kDrop});
  strict.line.plug_in();
  EXPECT_FALSE(strict.run_for_scans(1, 6 * kLdsSecond_ns));
  EXPECT_EQ(strict.driver.health().state, LaserState::kFailed);
}

TEST(LdsDriver, StampsAreEvenlySpaced) {
  LdsEmulatorSettings steady = an_xv11();
  steady.wobble = 0.0;
  LdsOnLine laser("xv11", steady);
  laser.line.plug_in();
  laser.run_for(20 * kLdsSecond_ns);
  ASSERT_GE(laser.scans.size(), 95U);
  for (std::size_t i = 20; i + 1 < laser.scans.size(); ++i) {
    const std::int64_t period_ns = laser.scans[i + 1].stamp_ns - laser.scans[i].stamp_ns;
    EXPECT_NEAR(static_cast<double>(period_ns), 2e8, 3e6) << "scan " << i;
  }
}

/// A packet of an LD19.
std::vector<std::uint8_t> ld19_bytes(support::Random& random) {
  LdPacket packet;
  packet.start_cdeg = static_cast<std::uint16_t>(random.below(kLdTurnCdeg));
  for (LdPoint& point : packet.points) point = {12'345, 200};
  return ld_bytes(packet);
}

using LdsFault = TurningLaserFault<LdsOnLine>;
class Xv11Faults : public testing::TestWithParam<LdsFault> {};
class Lds01Faults : public testing::TestWithParam<LdsFault> {};

TEST_P(Xv11Faults, AThousandTimes) {
  LdsOnLine laser("xv11", an_xv11());
  expect_no_wrong_scan(laser, GetParam());
}

TEST_P(Lds01Faults, AThousandTimes) {
  LdsOnLine laser("lds01", an_lds01());
  LdsFault fault = GetParam();
  // Twenty doublings push the top bit of the first intensity out of the sum: a change of this bit,
  // which no range depends on, goes unnoticed.
  if (std::string(fault.name) == "BadChecksum") fault.counted = false;
  expect_no_wrong_scan(laser, fault);
}

const auto kName = [](const auto& fault) { return std::string(fault.param.name); };
INSTANTIATE_TEST_SUITE_P(All, Xv11Faults,
                         testing::ValuesIn(turning_laser_faults<LdsOnLine>(ld19_bytes,
                                                                           kLdsSecond_ns,
                                                                           3 * kLdsSecond_ns)),
                         kName);
INSTANTIATE_TEST_SUITE_P(All, Lds01Faults,
                         testing::ValuesIn(turning_laser_faults<LdsOnLine>(ld19_bytes,
                                                                           kLdsSecond_ns,
                                                                           5 * kLdsSecond_ns)),
                         kName);

}  // namespace
}  // namespace topogeo::devices
