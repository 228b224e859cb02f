#include "topogeo/devices/ldrobot_driver.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ldrobot_on_line.hpp"

namespace topogeo::devices {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kLdSecond_ns = 1'000'000'000;

std::uint64_t dropped(const LdRobotDriver& driver, const std::string& reason) {
  for (const auto& [name, count] : driver.health().drops) {
    if (name == reason) return count;
  }
  ADD_FAILURE() << "no drop is called " << reason;
  return 0;
}

TEST(LdRobotDriver, EveryTurnIsAScanOfWhatWasMeasured) {
  LdRobotOnLine laser;
  laser.line.plug_in();
  laser.run_for(20 * kLdSecond_ns);
  // 200 turns with numbers of points that vary; the first and the last are not whole.
  EXPECT_GE(laser.scans.size(), 197U);
  EXPECT_EQ(laser.wrong_scans, 0U);
  for (const LaserScan& scan : laser.scans) {
    ASSERT_EQ(scan.ranges_m.size(), 450U);
    // One in ten measurements has no return; interpolation fills few of them.
    const auto missing = std::ranges::count(scan.ranges_m, 0.0F);
    EXPECT_LT(missing, 90);
  }
  const LaserHealth health = laser.driver.health();
  EXPECT_EQ(health.state, LaserState::kRunning);
  EXPECT_NEAR(health.turns_hz, 10.0, 0.3);
  EXPECT_EQ(health.line, (LineSettings{230'400, Parity::kNone}));
  EXPECT_EQ(dropped(laser.driver, "bad checksum"), 0U);
  EXPECT_EQ(dropped(laser.driver, "implausible packet"), 0U);
  EXPECT_LE(dropped(laser.driver, "incomplete turn"), 1U);
}

TEST(LdRobotDriver, StampsAreEvenlySpacedThoughPacketsComeInBursts) {
  LdRobotOnLine laser({}, {.wobble = 0.0});
  laser.line.plug_in();
  laser.run_for(40 * kLdSecond_ns);  // beyond the wrap of the laser's clock at 30 s
  ASSERT_GE(laser.scans.size(), 395U);
  for (std::size_t i = 50; i + 1 < laser.scans.size(); ++i) {
    const std::int64_t period_ns = laser.scans[i + 1].stamp_ns - laser.scans[i].stamp_ns;
    EXPECT_NEAR(static_cast<double>(period_ns), 1e8, 3e6) << "scan " << i;
  }
}

TEST(LdRobotDriver, FollowsALaserThatTurnsSlower) {
  LdRobotOnLine laser;
  laser.line.plug_in();
  laser.run_for(2 * kLdSecond_ns);
  for (const double turns_hz : {9.0, 8.0, 7.0, 6.0, 5.0}) {
    laser.emulator.set_turns_hz(turns_hz);
    const std::size_t before = laser.scans.size();
    laser.run_for(2 * kLdSecond_ns);
    EXPECT_GE(static_cast<double>(laser.scans.size() - before), 2.0 * turns_hz * 0.97 - 2.0);
  }
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_NEAR(laser.driver.health().turns_hz, 5.0, 0.2);
}

TEST(LdRobotDriver, SilenceIsReportedAndEnds) {
  LdRobotOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 2 * kLdSecond_ns));
  laser.emulator.fall_silent(laser.line.now_ns());
  laser.run_for(2 * kLdSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kStarting);
  EXPECT_THAT(laser.driver.health().reason, HasSubstr("no packet for"));
  laser.run_for(5 * kLdSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_THAT(laser.driver.health().reason, HasSubstr("no bytes arrive"));
  laser.emulator.speak_again(laser.line.now_ns());
  EXPECT_TRUE(laser.run_for_scans(1, kLdSecond_ns / 2));
  EXPECT_EQ(laser.driver.health().state, LaserState::kRunning);
  EXPECT_EQ(laser.driver.health().searches, 1U);
  EXPECT_EQ(laser.wrong_scans, 0U);
}

TEST(LdRobotDriver, ALaserOfAnotherRateIsNamed) {
  LdRobotOnLine laser({}, {.line = {115'200, Parity::kNone}, .samples_hz = 2000.0});
  laser.line.plug_in();
  laser.run_for(6 * kLdSecond_ns);
  EXPECT_TRUE(laser.scans.empty());
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_THAT(laser.driver.health().reason, HasSubstr("laser.model"));
}

TEST(LdRobotDriver, TheRateOfTheLineIsASetting) {
  TurningLaserSettings settings;
  settings.baud = 460'800;
  LdRobotOnLine laser(settings, {.line = {460'800, Parity::kNone}});
  laser.line.plug_in();
  EXPECT_TRUE(laser.run_for_scans(3, kLdSecond_ns));
  EXPECT_EQ(laser.driver.health().line.baud, 460'800U);
}

TEST(LdRobotDriver, WeakReturnsMayBeLeftOut) {
  TurningLaserSettings settings;
  settings.least_intensity = 229;  // above that of the emulator
  LdRobotOnLine laser(settings);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, kLdSecond_ns));
  EXPECT_EQ(std::ranges::count(laser.scans[0].ranges_m, 0.0F), 450);
}

TEST(LdRobotDriver, ImpossibleSettingsAreRefused) {
  TurningLaserSettings settings;
  settings.beams = 4000;
  EXPECT_THROW(LdRobotDriver(laser_model("ld19"), settings), std::invalid_argument);
  settings = {};
  settings.silence_ns = 0;
  EXPECT_THROW(LdRobotDriver(laser_model("ld19"), settings), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::devices
