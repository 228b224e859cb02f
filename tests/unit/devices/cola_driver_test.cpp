// The driver of SICK lasers on a network: start in both dialects, scans with their times, faults.
#include "topogeo/devices/cola_driver.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/simulation/cola_emulator.hpp"

#include "turning_laser_faults.hpp"
#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kColaSecond_ns = 1'000'000'000;

simulation::ColaEmulatorSettings a_tim551(ColaDialect dialect = ColaDialect::kBinary) {
  simulation::ColaEmulatorSettings laser;
  laser.dialect = dialect;
  laser.name = "TiM551";
  laser.beams = 271;
  laser.step_deg = 1.0;
  laser.range_max_m = 10.0;
  return laser;
}

struct ColaOnLine : TurningLaserOnLine<ColaDriver, simulation::ColaEmulator> {
  explicit ColaOnLine(const simulation::ColaEmulatorSettings& laser = a_tim551(),
                      const TurningLaserSettings& turning = {}, const ColaSettings& settings = {})
      : TurningLaserOnLine(laser, laser_model("sick_tim551"), turning, settings) {}
  double slowest_hz = 19.0;
  double fastest_hz = 23.0;
};

TEST(ColaDriver, FindsTheDialectAndDeliversEveryScanAtItsTime) {
  for (const ColaDialect dialect : {ColaDialect::kText, ColaDialect::kBinary}) {
    ColaOnLine laser(a_tim551(dialect));
    EXPECT_EQ(laser.driver.health().state, LaserState::kOffline);
    laser.line.plug_in();
    ASSERT_TRUE(laser.run_for_scans(60, 8 * kColaSecond_ns)) << laser.driver.health().reason;
    EXPECT_EQ(laser.wrong_scans, 0U);
    const LaserHealth health = laser.driver.health();
    EXPECT_EQ(health.state, LaserState::kRunning);
    EXPECT_EQ(health.device, "TiM551, firmware V1.0");
    EXPECT_NEAR(health.turns_hz, 15.0, 0.1);
    const LaserScan& scan = laser.scans.back();
    ASSERT_EQ(scan.ranges_m.size(), 271U);
    EXPECT_NEAR(scan.angle_min_rad, -0.75 * std::numbers::pi, 1e-9);
    EXPECT_NEAR(scan.time_step_s, 1.0 / 15.0 / 360.0, 1e-6);
    EXPECT_LE(laser.emulator.scans_sent() - laser.scans.size(), 1U);
  }
}

TEST(ColaDriver, TheClockOfTheLaserWraps) {
  simulation::ColaEmulatorSettings emulated = a_tim551();
  emulated.clock_us = 0U - 3'000'000U;
  ColaOnLine laser(emulated);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(90, 10 * kColaSecond_ns));
  EXPECT_EQ(laser.wrong_scans, 0U);
  for (std::size_t i = 1; i < laser.scans.size(); ++i) {
    const std::int64_t apart_ns = laser.scans[i].stamp_ns - laser.scans[i - 1].stamp_ns;
    EXPECT_NEAR(static_cast<double>(apart_ns), 1e9 / 15.0, 2e6);
  }
}

TEST(ColaDriver, UpsideDownBeamsAreMirrored) {
  TurningLaserSettings settings;
  settings.upside_down = true;
  ColaOnLine laser(a_tim551(), settings);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 5 * kColaSecond_ns));
  LaserScan upright = laser.scans.back();
  EXPECT_LT(upright.time_step_s, 0.0);
  std::ranges::reverse(upright.ranges_m);
  upright.time_step_s = -upright.time_step_s;
  upright.first_beam_s = -upright.first_beam_s;
  upright.angle_min_rad =
      -(upright.angle_min_rad +
        static_cast<double>(upright.ranges_m.size() - 1) * upright.angle_step_rad);
  EXPECT_TRUE(laser.world.has(upright));
}

TEST(ColaDriver, ALaserWithOtherBeamsIsNamed) {
  simulation::ColaEmulatorSettings emulated = a_tim551();
  emulated.beams = 811;
  emulated.step_deg = 0.3333;
  ColaOnLine laser(emulated);
  laser.line.plug_in();
  laser.run_for(3 * kColaSecond_ns);
  EXPECT_TRUE(laser.scans.empty());
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_EQ(laser.driver.health().reason,
            "it sends 811 beams, expected 271 of a SICK TiM551 (laser.model, laser.beams, or the "
            "settings of the laser)");
}

TEST(ColaDriver, StatusOfTheLaserIsReported) {
  ColaOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 5 * kColaSecond_ns));
  laser.emulator.set_status(2);
  ASSERT_TRUE(laser.run_for_scans(3, kColaSecond_ns));
  EXPECT_TRUE(laser.driver.health().contaminated);
  EXPECT_EQ(laser.driver.health().fault, "");
  EXPECT_TRUE(laser.scans.back().contaminated);
  laser.emulator.set_status(1);
  ASSERT_TRUE(laser.run_for_scans(3, kColaSecond_ns));
  EXPECT_EQ(laser.driver.health().fault, "the laser reports an error");
}

TEST(ColaDriver, NoLaserIsAFailureWithAReason) {
  ColaOnLine laser;
  laser.emulator.switch_off();
  laser.line.plug_in();
  laser.run_for(20 * kColaSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_EQ(laser.driver.health().reason,
            "no scan of a SICK TiM551: is it on, and does it speak CoLa (laser.cola)?");
  laser.emulator.switch_on(laser.line.now_ns());
  EXPECT_TRUE(laser.run_for_scans(1, 10 * kColaSecond_ns));
}

TEST(ColaDriver, TheEndOfTheProgramStopsTheScans) {
  ColaOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 5 * kColaSecond_ns));
  laser.driver.end(laser.line.now_ns());
  laser.run_for(kColaSecond_ns / 10);
  const std::uint64_t sent = laser.emulator.scans_sent();
  laser.run_for(kColaSecond_ns);
  EXPECT_EQ(laser.emulator.scans_sent(), sent);
}

TEST(ColaDriver, BeamsOfTheFileAreExpected) {
  simulation::ColaEmulatorSettings emulated = a_tim551();
  emulated.beams = 541;
  emulated.step_deg = 0.5;
  ColaOnLine laser(emulated, {.beams = 541});
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(10, 8 * kColaSecond_ns)) << laser.driver.health().reason;
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_EQ(laser.scans.back().ranges_m.size(), 541U);
}

/// A scan of a laser with other beams.
std::vector<std::uint8_t> scan_of_another_sick(support::Random& random) {
  ColaScan scan;
  scan.start_us = static_cast<std::uint32_t>(random.below(1U << 31U));
  scan.sent_us = scan.start_us + 20'000;
  scan.turns_hz = 50.0;
  scan.first_deg = -45.0;
  scan.step_deg = 0.5;
  scan.ranges_m.assign(541, 9.5F);
  return cola_bytes(cola_telegram(scan, ColaDialect::kBinary));
}

class ColaFaults : public testing::TestWithParam<TurningLaserFault<ColaOnLine>> {};

TEST_P(ColaFaults, AThousandTimes) {
  simulation::ColaEmulatorSettings emulated = a_tim551();
  emulated.turns_hz = 21.0;  // so that the shortest silence hides a scan
  ColaOnLine laser(emulated);
  expect_no_wrong_scan(laser, GetParam());
}

// A text has no checksum, because TCP has one; so these are the faults of CoLa B.
INSTANTIATE_TEST_SUITE_P(All, ColaFaults,
                         testing::ValuesIn(turning_laser_faults<ColaOnLine>(scan_of_another_sick,
                                                                            kColaSecond_ns,
                                                                            8 * kColaSecond_ns)),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
