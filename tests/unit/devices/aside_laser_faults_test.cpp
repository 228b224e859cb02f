// Every fault a thousand times for lasers whose directions depend on their readings: the LD08,
// whose receiver lies beside its axis, and the YDLIDARs that measure by triangulation.
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/ldrobot_driver.hpp"
#include "topogeo/devices/ydlidar_driver.hpp"
#include "topogeo/simulation/ldrobot_emulator.hpp"
#include "topogeo/simulation/ydlidar_emulator.hpp"

#include "slotted_world.hpp"
#include "turning_laser_faults.hpp"
#include "turning_laser_on_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kAsideSecond_ns = 1'000'000'000;

simulation::LdRobotEmulatorSettings an_ld08() {
  simulation::LdRobotEmulatorSettings laser;
  laser.line = laser_model("ld08").line;
  laser.turns_hz = 5.0;
  laser.samples_hz = 2300.0;
  laser.range_max_m = 8.0;
  laser.beside_axis = true;
  return laser;
}

struct Ld08OnLine : TurningLaserOnLine<LdRobotDriver, simulation::LdRobotEmulator, SlottedWorld> {
  Ld08OnLine() : TurningLaserOnLine(an_ld08(), laser_model("ld08"), TurningLaserSettings{}) {}
  double slowest_hz = 4.5;
  double fastest_hz = 5.5;
};

simulation::YdLidarEmulatorSettings a_triangulating(const LaserModel& model) {
  constexpr double kSamplesOfTurn = 300.0;  // fewer than its own, so that the test is quick
  simulation::YdLidarEmulatorSettings laser;
  laser.line = model.line;
  laser.asked = model.family != "ydlidar_one_way";
  laser.reports_frequency = laser.asked;
  laser.triangulates = true;
  laser.turns_hz = model.turns_hz;
  laser.samples_hz = model.turns_hz * kSamplesOfTurn;
  laser.range_max_m = model.range_max_m;
  return laser;
}

TurningLaserSettings fewer_beams() {
  TurningLaserSettings settings;
  settings.beams = 300;
  return settings;
}

struct TriangulatingOnLine
    : TurningLaserOnLine<YdLidarDriver, simulation::YdLidarEmulator, SlottedWorld> {
  explicit TriangulatingOnLine(const LaserModel& model)
      : TurningLaserOnLine(a_triangulating(model), model, fewer_beams(), RpMotor::kModel),
        slowest_hz(0.9 * model.turns_hz),
        fastest_hz(1.1 * model.turns_hz) {
    world.time_error_ns = 30'000'000;  // a packet of 40 samples takes up to 20 ms
  }
  double slowest_hz;
  double fastest_hz;
};

/// Bytes of an LDS-01: its header, and random ones.
std::vector<std::uint8_t> bytes_of_an_lds01(support::Random& random) {
  std::vector<std::uint8_t> bytes{0xFA, 0xA0};
  while (bytes.size() < 42) bytes.push_back(static_cast<std::uint8_t>(random.below(256)));
  return bytes;
}

class Ld08Faults : public testing::TestWithParam<TurningLaserFault<Ld08OnLine>> {};

TEST_P(Ld08Faults, AThousandTimes) {
  Ld08OnLine laser;
  expect_no_wrong_scan(laser, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, Ld08Faults,
                         testing::ValuesIn(turning_laser_faults<Ld08OnLine>(bytes_of_an_lds01,
                                                                            kAsideSecond_ns,
                                                                            8 * kAsideSecond_ns)),
                         [](const auto& fault) { return std::string(fault.param.name); });

using TriangulatingFault = std::tuple<std::string, TurningLaserFault<TriangulatingOnLine>>;

class TriangulatingFaults : public testing::TestWithParam<TriangulatingFault> {};

TEST_P(TriangulatingFaults, AThousandTimes) {
  TriangulatingOnLine laser(laser_model(std::get<0>(GetParam())));
  expect_no_wrong_scan(laser, std::get<1>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(
    All, TriangulatingFaults,
    testing::Combine(testing::Values("ydlidar_x2", "ydlidar_x4", "ydlidar_g4"),
                     testing::ValuesIn(turning_laser_faults<TriangulatingOnLine>(
                         bytes_of_an_lds01, kAsideSecond_ns, 8 * kAsideSecond_ns))),
    [](const auto& fault) { return std::get<0>(fault.param) + std::get<1>(fault.param).name; });

}  // namespace
}  // namespace topogeo::devices
