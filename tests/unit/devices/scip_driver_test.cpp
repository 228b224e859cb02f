// The driver of Hokuyo lasers on a simulated line: start, scans with their times, faults.
#include "topogeo/devices/scip_driver.hpp"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/simulation/scip_emulator.hpp"

#include "slotted_world.hpp"
#include "turning_laser_faults.hpp"
#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kScipTestMs_ns = 1'000'000;
constexpr std::int64_t kScipTestSecond_ns = 1'000'000'000;

struct ScipOnLine : TurningLaserOnLine<ScipDriver, simulation::ScipEmulator> {
  explicit ScipOnLine(const TurningLaserSettings& turning = {}, const ScipSettings& settings = {},
                      const simulation::ScipEmulatorSettings& laser = {})
      : TurningLaserOnLine(laser, laser_model("ust_20lx"), turning, settings) {}
};

TEST(ScipDriver, AsksForTheSweepAndDeliversEveryScanAtItsTime) {
  ScipOnLine laser;
  EXPECT_EQ(laser.driver.health().state, LaserState::kOffline);
  laser.line.plug_in();
  EXPECT_EQ(laser.driver.health().state, LaserState::kStarting);
  ASSERT_TRUE(laser.run_for_scans(40, 3 * kScipTestSecond_ns)) << laser.driver.health().reason;
  EXPECT_EQ(laser.wrong_scans, 0U);
  const LaserHealth health = laser.driver.health();
  EXPECT_EQ(health.state, LaserState::kRunning);
  EXPECT_EQ(
      health.device,
      "UST-20LX(Hokuyo Automatic Co., Ltd.), firmware 1.0.0(emulator), serial number H0000001");
  EXPECT_NEAR(health.turns_hz, 40.0, 0.5);
  const LaserScan& scan = laser.scans.back();
  ASSERT_EQ(scan.ranges_m.size(), 1081U);
  EXPECT_NEAR(scan.angle_min_rad, -0.75 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(scan.angle_step_rad, std::numbers::pi / 720.0, 1e-9);
  EXPECT_NEAR(scan.time_step_s, 0.025 / 1440, 1e-6);
  EXPECT_NEAR(scan.first_beam_s, -540 * scan.time_step_s, 1e-9);
  EXPECT_LE(laser.emulator.scans_sent() - laser.scans.size(), 1U);
}

// Without the laser's time the 11 ms that a scan takes on the line are not known.
TEST(ScipDriver, StampsOfScansAreThoseOfTheLaserWithinTwoMilliseconds) {
  for (const bool answers_time : {true, false}) {
    simulation::ScipEmulatorSettings emulated;
    emulated.answers_time = answers_time;
    ScipOnLine laser({}, {}, emulated);
    laser.world.time_error_ns = (answers_time ? 0 : 11 * kScipTestMs_ns) + 5 * kScipTestMs_ns / 2;
    laser.line.plug_in();
    ASSERT_TRUE(laser.run_for_scans(200, 10 * kScipTestSecond_ns)) << laser.driver.health().reason;
    EXPECT_EQ(laser.wrong_scans, 0U) << "time answered: " << answers_time;
  }
}

TEST(ScipDriver, ReadsTwoCharactersAndIntensities) {
  for (const auto kind : {ScipScanKind::kTwoCharacters, ScipScanKind::kIntensities}) {
    ScipSettings settings;
    settings.kind = kind;
    ScipOnLine laser({}, settings);
    laser.line.plug_in();
    ASSERT_TRUE(laser.run_for_scans(10, 3 * kScipTestSecond_ns)) << laser.driver.health().reason;
    EXPECT_EQ(laser.wrong_scans, 0U);
    float largest_m = 0.0F;
    for (const float range_m : laser.scans.back().ranges_m)
      largest_m = std::max(largest_m, range_m);
    EXPECT_EQ(largest_m > 4.095F, kind == ScipScanKind::kIntensities);
  }
  ScipSettings bright;
  bright.kind = ScipScanKind::kIntensities;
  bright.least_intensity = 2001;
  ScipOnLine laser({}, bright);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 3 * kScipTestSecond_ns));
  for (const float range_m : laser.scans.back().ranges_m) EXPECT_EQ(range_m, 0.0F);
}

TEST(ScipDriver, TheClockOfTheLaserWraps) {
  simulation::ScipEmulatorSettings emulated;
  emulated.clock_ms = kScipTimeWrap_ms - 1000;
  ScipOnLine laser({}, {}, emulated);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(120, 10 * kScipTestSecond_ns));
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_LE(laser.emulator.scans_sent() - laser.scans.size(), 1U);
  for (std::size_t i = 1; i < laser.scans.size(); ++i) {
    const std::int64_t apart_ns = laser.scans[i].stamp_ns - laser.scans[i - 1].stamp_ns;
    EXPECT_NEAR(static_cast<double>(apart_ns), 25e6, 2e6);
  }
}

TEST(ScipDriver, UpsideDownBeamsAreMirrored) {
  TurningLaserSettings settings;
  settings.upside_down = true;
  ScipOnLine laser(settings);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 3 * kScipTestSecond_ns));
  const LaserScan& scan = laser.scans.back();
  EXPECT_LT(scan.time_step_s, 0.0);
  EXPECT_GT(scan.first_beam_s, 0.0);
  LaserScan upright = scan;
  std::ranges::reverse(upright.ranges_m);
  upright.time_step_s = -scan.time_step_s;
  upright.first_beam_s = -scan.first_beam_s;
  upright.angle_min_rad =
      -(scan.angle_min_rad + static_cast<double>(scan.ranges_m.size() - 1) * scan.angle_step_rad);
  EXPECT_TRUE(laser.world.has(upright));
}

TEST(ScipDriver, ALaserInTroubleIsReportedAndStartedAgain) {
  ScipOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 3 * kScipTestSecond_ns));
  laser.emulator.set_trouble("55");
  laser.run_for(200 * kScipTestMs_ns);
  EXPECT_EQ(laser.driver.health().fault, "hardware trouble, status 55");
  EXPECT_EQ(laser.driver.health().error_level, 4);
  laser.run_for(5 * kScipTestSecond_ns);
  laser.emulator.set_trouble("");
  EXPECT_TRUE(laser.run_for_scans(3, 5 * kScipTestSecond_ns));
  EXPECT_EQ(laser.driver.health().fault, "");
  EXPECT_EQ(laser.driver.health().state, LaserState::kRunning);
}

TEST(ScipDriver, ALaserWithAnotherSweepIsNamed) {
  simulation::ScipEmulatorSettings emulated;
  emulated.sweep = {"URG-04LX", 20, 5600, 1024, 44, 725, 384, 600};
  ScipOnLine laser({}, {}, emulated);
  laser.line.plug_in();
  laser.run_for(kScipTestSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_EQ(laser.driver.health().reason,
            "it is a URG-04LX with 682 beams, expected a Hokuyo UST-20LX with 1081 (laser.model)");
  laser.run_for(10 * kScipTestSecond_ns);
  EXPECT_TRUE(laser.scans.empty());
}

TEST(ScipDriver, NoLaserIsAFailureWithAReason) {
  ScipOnLine laser;
  laser.emulator.switch_off();
  laser.line.plug_in();
  laser.run_for(20 * kScipTestSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_EQ(laser.driver.health().reason,
            "no answer of a Hokuyo UST-20LX: is it connected and switched on?");
  laser.emulator.switch_on(laser.line.now_ns());
  EXPECT_TRUE(laser.run_for_scans(1, 10 * kScipTestSecond_ns));
}

TEST(ScipDriver, TheEndOfTheProgramStopsTheScans) {
  ScipOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 3 * kScipTestSecond_ns));
  laser.driver.end(laser.line.now_ns());
  laser.run_for(100 * kScipTestMs_ns);
  const std::uint64_t sent = laser.emulator.scans_sent();
  laser.run_for(kScipTestSecond_ns);
  EXPECT_EQ(laser.emulator.scans_sent(), sent);
}

/// A scan of a laser with other steps.
std::vector<std::uint8_t> scan_of_another_hokuyo(support::Random& random) {
  const ScipScanRequest request{ScipScanKind::kThreeCharacters, 0, 1080};
  ScipScan scan;
  scan.time_ms = static_cast<std::uint32_t>(random.below(kScipTimeWrap_ms));
  scan.distances_mm.assign(1081, 12'345);
  const std::string text = scip_text(scip_command(request), scip_answer_of(scan, request));
  return {text.begin(), text.end()};
}

simulation::ScipEmulatorSettings a_urg() {
  simulation::ScipEmulatorSettings laser;
  laser.sweep = {"URG-04LX", 20, 5600, 1024, 44, 725, 384, 1250};
  return laser;
}

/// The laser with the fewest beams, so that the test is quick. It turns fast enough that the
/// shortest silence hides a scan.
struct UrgOnLine : TurningLaserOnLine<ScipDriver, simulation::ScipEmulator, SlottedWorld> {
  UrgOnLine()
      : TurningLaserOnLine(a_urg(), laser_model("urg_04lx"), TurningLaserSettings{},
                           ScipSettings{}) {
    world.time_error_ns = 6 * kScipTestMs_ns;
  }
  double slowest_hz = 19.0;
  double fastest_hz = 23.0;
};

class ScipFaults : public testing::TestWithParam<TurningLaserFault<UrgOnLine>> {};

TEST_P(ScipFaults, AThousandTimes) {
  UrgOnLine laser;
  expect_no_wrong_scan(laser, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, ScipFaults,
                         testing::ValuesIn(turning_laser_faults<UrgOnLine>(scan_of_another_hokuyo,
                                                                           kScipTestSecond_ns,
                                                                           8 * kScipTestSecond_ns)),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
