#include "topogeo/devices/rplidar_driver.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/simulation/rplidar_emulator.hpp"

#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::LaserFault;
using simulation::RpLidarEmulatorSettings;
using testing::HasSubstr;

constexpr std::int64_t kRpTestMs_ns = 1'000'000;
constexpr std::int64_t kRpTestSecond_ns = 1000 * kRpTestMs_ns;

struct RpOnLine : TurningLaserOnLine<RpLidarDriver, simulation::RpLidarEmulator> {
  explicit RpOnLine(const RpLidarSettings& settings = {}, const RpLidarEmulatorSettings& laser = {},
                    const TurningLaserSettings& turning = {}, const char* model = "rplidar_a1")
      : TurningLaserOnLine(laser, laser_model(model), turning, settings) {
    // A packet of 32 points takes 8 ms.
    world.time_error_ns = 12 * kRpTestMs_ns;
  }
};

TEST(RpLidarDriver, StartsAnExpressScanAndLosesNoTurn) {
  RpOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 3 * kRpTestSecond_ns)) << laser.driver.health().reason;
  EXPECT_EQ(laser.emulator.scans(), rp_answer::kExpress);
  const std::uint64_t turns = laser.emulator.scans_sent();
  laser.scans.clear();
  laser.run_for(20 * kRpTestSecond_ns);
  EXPECT_GE(laser.scans.size(), 108U);
  EXPECT_LE(laser.scans.size(), laser.emulator.scans_sent() - turns + 1);
  EXPECT_EQ(laser.wrong_scans, 0U);
  for (const LaserScan& scan : laser.scans) {
    ASSERT_EQ(scan.ranges_m.size(), laser_model("rplidar_a1").beams);
    EXPECT_LT(std::ranges::count(scan.ranges_m, 0.0F), 160);
  }
  const LaserHealth health = laser.driver.health();
  EXPECT_EQ(health.state, LaserState::kRunning);
  EXPECT_EQ(health.device, "RPLIDAR, model 24, firmware 1.29, hardware 7");
  EXPECT_NEAR(health.turns_hz, 5.5, 0.2);
  for (const auto& [reason, count] : health.drops) EXPECT_LE(count, 2U) << reason;
}

TEST(RpLidarDriver, StandardAndDenseScansAreDecodedToo) {
  RpLidarSettings standard;
  standard.scan = RpScan::kStandard;
  RpOnLine slow(standard);
  slow.line.plug_in();
  ASSERT_TRUE(slow.run_for_scans(10, 5 * kRpTestSecond_ns)) << slow.driver.health().reason;
  EXPECT_EQ(slow.emulator.scans(), rp_answer::kScan);
  EXPECT_EQ(slow.wrong_scans, 0U);

  RpLidarSettings dense;
  dense.scan = RpScan::kExpress;
  dense.express_mode = 1;
  RpOnLine fast(dense);
  fast.line.plug_in();
  ASSERT_TRUE(fast.run_for_scans(10, 5 * kRpTestSecond_ns)) << fast.driver.health().reason;
  EXPECT_EQ(fast.emulator.scans(), rp_answer::kDense);
  EXPECT_EQ(fast.wrong_scans, 0U);
}

TEST(RpLidarDriver, TheMotorIsStartedAsTheSeriesNeedsItAndStoppedAtTheEnd) {
  struct Series {
    std::uint8_t model;
    std::uint8_t command;
    std::uint16_t value;
  };
  for (const Series& series : {Series{0x18, 0, 0}, Series{0x28, rp_command::kMotorPwm, 660},
                               Series{0x61, rp_command::kMotorSpeed, 600}}) {
    RpOnLine laser({}, {.model = series.model});
    laser.line.plug_in();
    ASSERT_TRUE(laser.run_for_scans(1, 3 * kRpTestSecond_ns));
    EXPECT_EQ(laser.emulator.motor_command(), series.command);
    EXPECT_EQ(laser.emulator.motor_value(), series.value);
    laser.driver.end(laser.line.now_ns());
    laser.run_for(kRpTestSecond_ns);
    EXPECT_EQ(laser.emulator.scans(), 0) << "the scan ends";
    EXPECT_EQ(laser.emulator.motor_value(), 0);
    EXPECT_EQ(laser.driver.health().state, LaserState::kOffline);
  }
}

TEST(RpLidarDriver, DtrStartsAndStopsTheMotor) {
  RpLidarDriver driver(laser_model("rplidar_a1"), {}, {});
  driver.opened(0);
  const std::vector<LineOrder> start = driver.take_orders();
  ASSERT_EQ(start.size(), 2U);
  EXPECT_EQ(start[0].settings, (LineSettings{115'200, Parity::kNone}));
  EXPECT_EQ(start[1].dtr, std::optional<bool>{false});
  driver.end(1);
  const std::vector<LineOrder> end = driver.take_orders();
  EXPECT_EQ(end.front().bytes, rp_request(rp_command::kStop));
  EXPECT_EQ(end.back().dtr, std::optional<bool>{true});
}

TEST(RpLidarDriver, AnErrorIsReportedAndResetOnce) {
  RpOnLine laser({}, {.health = 2, .error_code = 0x8001});
  laser.line.plug_in();
  laser.run_for(500 * kRpTestMs_ns);
  EXPECT_THAT(laser.driver.health().reason, HasSubstr("code 32769"));
  EXPECT_EQ(laser.driver.health().error_level, 3);
  EXPECT_TRUE(laser.run_for_scans(1, 10 * kRpTestSecond_ns));
  EXPECT_EQ(laser.driver.health().error_level, 0);
}

TEST(RpLidarDriver, OldFirmwareWithoutASampleRateScansToo) {
  RpOnLine laser({}, {.knows_sample_rate = false});
  laser.line.plug_in();
  EXPECT_TRUE(laser.run_for_scans(3, 5 * kRpTestSecond_ns));
  EXPECT_EQ(laser.wrong_scans, 0U);
}

TEST(RpLidarDriver, AnotherRateOrLaserIsNamed) {
  RpOnLine laser({}, {.line = {256'000, Parity::kNone}});
  laser.line.plug_in();
  laser.run_for(20 * kRpTestSecond_ns);
  EXPECT_EQ(laser.driver.health().state, LaserState::kFailed);
  EXPECT_THAT(laser.driver.health().reason, HasSubstr("laser.model"));
  EXPECT_TRUE(laser.scans.empty());
}

struct RpFault {
  const char* name;
  void (*inject)(RpOnLine&, support::Random&);
  std::int64_t allowed_ns;  ///< until the next scan
  bool counted;             ///< in the drops of the driver
};

std::int64_t rp_between(support::Random& random, std::int64_t low_ns, std::int64_t high_ns) {
  return low_ns +
         static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(high_ns - low_ns)));
}

template <LaserFault kFault, int kMost>
void rp_strike(RpOnLine& laser, support::Random& random) {
  laser.emulator.faults().inject(kFault, 1 + static_cast<int>(random.below(kMost)));
  while (laser.emulator.faults().pending(kFault) > 0) laser.run_for(8 * kRpTestMs_ns);
}

void rp_unplug(RpOnLine& laser, support::Random& random) {
  laser.line.unplug();
  laser.run_for(rp_between(random, kRpTestMs_ns, 2 * kRpTestSecond_ns));
  laser.line.plug_in();
}

void rp_silence(RpOnLine& laser, support::Random& random) {
  laser.emulator.fall_silent(laser.line.now_ns());
  laser.run_for(rp_between(random, 50 * kRpTestMs_ns, 2 * kRpTestSecond_ns));
  laser.emulator.speak_again(laser.line.now_ns());
}

void rp_restart(RpOnLine& laser, support::Random& /*random*/) {
  laser.emulator.switch_off();
  laser.emulator.switch_on(laser.line.now_ns());
}

/// Bytes of another laser instead of its own.
void rp_other_laser(RpOnLine& laser, support::Random& random) {
  bool done = false;
  laser.line.set_filter([&](std::vector<std::uint8_t>& bytes) {
    if (done || bytes.empty()) return;
    LdPacket packet;
    packet.start_cdeg = static_cast<std::uint16_t>(random.below(kLdTurnCdeg));
    packet.time_ms = static_cast<std::uint16_t>(random.below(kLdTimeWrap_ms));
    for (LdPoint& point : packet.points) point = {12'345, 200};
    bytes = ld_bytes(packet);
    done = true;
  });
  while (!done) laser.run_for(kRpTestMs_ns);
  laser.line.set_filter({});
}

class RpLidarFaults : public testing::TestWithParam<RpFault> {};

TEST_P(RpLidarFaults, AThousandTimes) {
  const RpFault& fault = GetParam();
  support::Random random(4);
  // A line with room for the bytes of the faults: on a full one every packet would stay late.
  const RpLidarEmulatorSettings fast{.line = {256'000, Parity::kNone}};
  TurningLaserSettings turning;
  turning.beams = 720;
  RpOnLine laser({}, fast, turning, "rplidar_a3");
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 5 * kRpTestSecond_ns));
  const auto drops = [&laser] {
    const LaserHealth health = laser.driver.health();
    std::uint64_t sum = health.searches;
    for (const auto& [reason, count] : health.drops) sum += count;
    return sum;
  };
  std::size_t late = 0;
  std::size_t silently = 0;
  for (int time = 0; time < 1000; ++time) {
    laser.run_for(rp_between(random, 0, 200 * kRpTestMs_ns));
    const std::uint64_t before = drops();
    fault.inject(laser, random);
    if (!laser.run_for_scans(1, fault.allowed_ns)) ++late;
    laser.run_for(100 * kRpTestMs_ns);
    if (fault.counted && drops() == before) ++silently;
    laser.scans.clear();
  }
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_EQ(late, 0U);
  EXPECT_EQ(silently, 0U);
}

INSTANTIATE_TEST_SUITE_P(
    All, RpLidarFaults,
    testing::Values(
        RpFault{"BadChecksum", rp_strike<LaserFault::kBadChecksum, 5>, kRpTestSecond_ns, true},
        RpFault{"Truncated", rp_strike<LaserFault::kTruncated, 5>, kRpTestSecond_ns, true},
        RpFault{"Noise", rp_strike<LaserFault::kGarbage, 5>, kRpTestSecond_ns, true},
        RpFault{"Doubled", rp_strike<LaserFault::kDoubled, 5>, kRpTestSecond_ns, true},
        RpFault{"Stuck", rp_strike<LaserFault::kStuckScan, 20>, 2 * kRpTestSecond_ns, true},
        RpFault{"WrongModel", rp_other_laser, kRpTestSecond_ns, true},
        RpFault{"Unplugged", rp_unplug, 3 * kRpTestSecond_ns, false},
        RpFault{"Silent", rp_silence, 12 * kRpTestSecond_ns, true},
        RpFault{"Restarted", rp_restart, 12 * kRpTestSecond_ns, true}),
    [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
