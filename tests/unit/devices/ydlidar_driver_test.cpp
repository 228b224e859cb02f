#include "topogeo/devices/ydlidar_driver.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/simulation/ydlidar_emulator.hpp"

#include "turning_laser_faults.hpp"
#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::YdLidarEmulatorSettings;
using testing::HasSubstr;

constexpr std::int64_t kYdSecond_ns = 1'000'000'000;

struct YdOnLine : TurningLaserOnLine<YdLidarDriver, simulation::YdLidarEmulator> {
  explicit YdOnLine(const YdLidarEmulatorSettings& laser = {}, const char* model = "ydlidar_tg")
      : TurningLaserOnLine(laser, laser_model(model), TurningLaserSettings{}, RpMotor::kModel) {
    // A packet of 40 samples takes up to 8 ms, and a motor that changes its speed during a turn
    // bends the angles over time.
    world.time_error_ns = 16'000'000;
  }
  double slowest_hz = 8.0;
  double fastest_hz = 11.0;
};

/// A laser whose turns have as many samples as its scans have beams.
YdLidarEmulatorSettings a_triangulating_laser() {
  YdLidarEmulatorSettings laser;
  laser.line.baud = 230'400;
  laser.triangulates = true;
  laser.samples_hz = 9000.0;
  laser.range_max_m = 16.0;
  return laser;
}

TEST(YdLidarDriver, StartsAScanAndLosesNoTurn) {
  YdOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 2 * kYdSecond_ns)) << laser.driver.health().reason;
  laser.run_for(10 * kYdSecond_ns);
  EXPECT_GE(laser.scans.size(), 98U);
  EXPECT_EQ(laser.wrong_scans, 0U);
  const LaserHealth health = laser.driver.health();
  EXPECT_EQ(health.state, LaserState::kRunning);
  EXPECT_EQ(health.device, "YDLIDAR, model 100, firmware 1.71, hardware 2");
  EXPECT_EQ(health.error_level, 0);
  EXPECT_NEAR(health.turns_hz, 10.0, 0.3);
  for (const auto& [reason, count] : health.drops) {
    // The first turns show the rate of the samples, the next tenth of a second how late they come.
    EXPECT_LE(count, reason == "packet without time" ? 500U : 1U) << reason;
  }
}

TEST(YdLidarDriver, MeasuresTheFrequencyThatALaserDoesNotReport) {
  YdLidarEmulatorSettings silent;
  silent.reports_frequency = false;
  silent.turns_hz = 8.5;
  YdOnLine laser(silent);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(20, 6 * kYdSecond_ns)) << laser.driver.health().reason;
  EXPECT_NEAR(laser.driver.health().turns_hz, 8.5, 0.3);
  laser.wrong_scans = 0;
  laser.run_for(10 * kYdSecond_ns);
  EXPECT_EQ(laser.wrong_scans, 0U);
}

TEST(YdLidarDriver, StopsTheScanAtTheEnd) {
  YdOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(1, 2 * kYdSecond_ns));
  EXPECT_TRUE(laser.emulator.scans());
  laser.driver.end(laser.line.now_ns());
  laser.run_for(kYdSecond_ns / 10);
  EXPECT_FALSE(laser.emulator.scans());
  EXPECT_EQ(laser.driver.health().state, LaserState::kOffline);
}

TEST(YdLidarDriver, DtrStartsTheMotorOfAnX4) {
  YdLidarDriver driver(laser_model("ydlidar_x4"), {}, RpMotor::kModel);
  driver.opened(0);
  driver.tick(0);
  const std::vector<LineOrder> start = driver.take_orders();
  ASSERT_EQ(start.size(), 3U);
  EXPECT_EQ(start[0].settings, (LineSettings{128'000, Parity::kNone}));
  EXPECT_EQ(start[1].dtr, std::optional<bool>{true});
  EXPECT_EQ(start[2].bytes, yd_request(yd_command::kStop));
  driver.tick(kYdSecond_ns);
  EXPECT_EQ(driver.take_orders().back().bytes, yd_request(yd_command::kScan));
  driver.end(kYdSecond_ns);
  EXPECT_EQ(driver.take_orders().back().dtr, std::optional<bool>{false});
}

TEST(YdLidarDriver, AnX2IsNotAsked) {
  YdLidarDriver driver(laser_model("ydlidar_x2"), {}, RpMotor::kNone);
  driver.opened(0);
  driver.tick(kYdSecond_ns);
  const std::vector<LineOrder> orders = driver.take_orders();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_TRUE(orders[0].bytes.empty());
}

TEST(YdLidarDriver, AnErrorOfTheLaserIsReported) {
  YdLidarEmulatorSettings failing;
  failing.health = 2;
  YdOnLine laser(failing);
  laser.line.plug_in();
  laser.run_for(kYdSecond_ns);
  EXPECT_EQ(laser.driver.health().error_level, 3);
}

// A square room of 2 m around a laser that measures by triangulation. Without the correction each
// wall would be turned by 5 to 8 degrees.
TEST(YdLidarDriver, CorrectsTheAnglesOfATriangulatingLaser) {
  const LaserModel& model = laser_model("ydlidar_g4");
  YdLidarDriver driver(model, {}, RpMotor::kModel);
  const auto room_m = [](double angle_rad) {
    return 1.0 / std::max(std::fabs(std::cos(angle_rad)), std::fabs(std::sin(angle_rad)));
  };
  simulation::YdLidarEmulator emulator(
      a_triangulating_laser(), [&](const simulation::BeamPattern& beams, std::int64_t) {
        std::vector<float> ranges_m;
        for (std::size_t i = 0; i < beams.count; ++i) {
          ranges_m.push_back(static_cast<float>(
              room_m(beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad)));
        }
        return ranges_m;
      });
  SimulatedLine line(driver, emulator);
  line.plug_in();
  std::vector<LaserScan> scans;
  ASSERT_TRUE(line.run_until(3 * kYdSecond_ns, [&] {
    for (LaserScan& scan : driver.take_scans()) scans.push_back(std::move(scan));
    return scans.size() >= 3;
  }));
  const LaserScan& scan = scans.back();
  ASSERT_EQ(scan.ranges_m.size(), model.beams);
  std::size_t missing = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double angle_rad = scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad;
    if (scan.ranges_m[i] == 0.0F) {
      ++missing;
    } else {
      EXPECT_NEAR(scan.ranges_m[i], room_m(angle_rad), 0.015) << "beam " << i;
    }
  }
  EXPECT_LT(missing, 20U);
}

/// A packet of an LD19.
std::vector<std::uint8_t> ld19_on_yd_line(support::Random& random) {
  LdPacket packet;
  packet.start_cdeg = static_cast<std::uint16_t>(random.below(kLdTurnCdeg));
  for (LdPoint& point : packet.points) point = {12'345, 200};
  return ld_bytes(packet);
}

class YdLidarFaults : public testing::TestWithParam<TurningLaserFault<YdOnLine>> {};

TEST_P(YdLidarFaults, AThousandTimes) {
  YdLidarEmulatorSettings fewer;  // samples, so that the test is quick
  fewer.samples_hz = 5000.0;
  YdOnLine laser(fewer);
  expect_no_wrong_scan(laser, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, YdLidarFaults,
                         testing::ValuesIn(turning_laser_faults<YdOnLine>(ld19_on_yd_line,
                                                                          kYdSecond_ns,
                                                                          8 * kYdSecond_ns)),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
