#include "topogeo/devices/rplidar_driver.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/simulation/rplidar_emulator.hpp"

#include "turning_laser_faults.hpp"
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

using RpFault = TurningLaserFault<RpOnLine>;

void rp_restart(RpOnLine& laser, support::Random& /*random*/) {
  laser.emulator.switch_off();
  laser.emulator.switch_on(laser.line.now_ns());
}

std::vector<std::uint8_t> bytes_of_an_ld19(support::Random& random) {
  LdPacket packet;
  packet.start_cdeg = static_cast<std::uint16_t>(random.below(kLdTurnCdeg));
  packet.time_ms = static_cast<std::uint16_t>(random.below(kLdTimeWrap_ms));
  for (LdPoint& point : packet.points) point = {12'345, 200};
  return ld_bytes(packet);
}

class RpLidarFaults : public testing::TestWithParam<RpFault> {};

TEST_P(RpLidarFaults, AThousandTimes) {
  // A line with room for the bytes of the faults: on a full one every packet would stay late.
  const RpLidarEmulatorSettings fast{.line = {256'000, Parity::kNone}};
  TurningLaserSettings turning;
  turning.beams = 720;
  RpOnLine laser({}, fast, turning, "rplidar_a3");
  expect_no_wrong_scan(laser, GetParam(), {5 * kRpTestSecond_ns, 100 * kRpTestMs_ns});
}

INSTANTIATE_TEST_SUITE_P(
    All, RpLidarFaults,
    testing::Values(
        RpFault{"BadChecksum", struck_by<RpOnLine>(LaserFault::kBadChecksum, 5), kRpTestSecond_ns},
        RpFault{"Truncated", struck_by<RpOnLine>(LaserFault::kTruncated, 5), kRpTestSecond_ns},
        RpFault{"Noise", struck_by<RpOnLine>(LaserFault::kGarbage, 5), kRpTestSecond_ns},
        RpFault{"Doubled", struck_by<RpOnLine>(LaserFault::kDoubled, 5), kRpTestSecond_ns},
        RpFault{"Stuck", struck_by<RpOnLine>(LaserFault::kStuckScan, 20), 2 * kRpTestSecond_ns},
        RpFault{"WrongModel", other_laser<RpOnLine>(bytes_of_an_ld19), kRpTestSecond_ns},
        RpFault{"Unplugged", unplug_for_a_while<RpOnLine>, 3 * kRpTestSecond_ns, false},
        RpFault{"Silent", silence_for_a_while<RpOnLine>, 12 * kRpTestSecond_ns},
        RpFault{"Restarted", rp_restart, 12 * kRpTestSecond_ns}),
    [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
