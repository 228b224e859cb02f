#include "topogeo/devices/laser_models.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/simulation/laser_emulator.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kLaserSecond_ns = 1'000'000'000;

TEST(LaserModels, TheDefaultIsTheSickPls) {
  EXPECT_EQ(laser_models().front().name, "sick_pls");
  EXPECT_EQ(&laser_model("sick_pls"), &laser_models().front());
  EXPECT_THROW((void)laser_model("sick"), std::invalid_argument);
}

TEST(LaserModels, NamesAreUnique) {
  std::set<std::string> names;
  for (const LaserModel& model : laser_models()) names.emplace(model.name);
  EXPECT_EQ(names.size(), laser_models().size());
}

class EachLaserModel : public testing::TestWithParam<std::string> {};

TEST_P(EachLaserModel, ItsDriverGetsScansFromItsEmulatorThroughItsInterface) {
  const LaserModel& model = laser_model(GetParam());
  LaserSettings settings;
  settings.model = &model;
  const auto driver = make_laser_driver(settings);
  // A wall on the left at 1 m, one on the right at 2 m.
  const auto walls = [](const simulation::BeamPattern& beams, std::int64_t) {
    std::vector<float> ranges_m;
    for (std::size_t i = 0; i < beams.count; ++i) {
      const double angle_rad = beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad;
      ranges_m.push_back(std::sin(angle_rad) > 0.0 ? 1.0F : 2.0F);
    }
    return ranges_m;
  };
  simulation::LaserEmulatorSettings emulated;
  emulated.model = &model;
  const auto emulator = simulation::make_laser_emulator(emulated, walls);
  SimulatedLine line(*driver, *emulator);
  EXPECT_EQ(driver->health().state, LaserState::kOffline);
  line.plug_in();
  EXPECT_EQ(driver->health().state, LaserState::kStarting);
  std::vector<LaserScan> scans;
  const bool came = line.run_until(30 * kLaserSecond_ns, [&] {
    for (LaserScan& scan : driver->take_scans()) scans.push_back(std::move(scan));
    return scans.size() >= 3;
  });
  ASSERT_TRUE(came) << driver->health().reason;
  EXPECT_EQ(driver->health().state, LaserState::kRunning);
  EXPECT_EQ(driver->health().line.parity, model.line.parity);
  EXPECT_GE(emulator->scans_sent(), 3U);
  const LaserScan& scan = scans.back();
  ASSERT_EQ(scan.ranges_m.size(), model.beams);
  const simulation::BeamPattern beams = simulation::beams_of(model);
  // The front of a URG-04LX is not the middle of its sweep, steps 44 to 725, but step 384.
  const double aside_rad = model.name == "urg_04lx" ? 0.5 * beams.angle_step_rad : 0.0;
  EXPECT_NEAR(scan.angle_min_rad, beams.angle_min_rad + aside_rad, 1e-12);
  // A SICK safety scanner sends angles in 1/4194304 of a degree.
  EXPECT_NEAR(scan.angle_step_rad, beams.angle_step_rad, 1e-8);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double side = std::sin(scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    if (std::fabs(side) < 0.05) continue;
    EXPECT_NEAR(scan.ranges_m[i], side > 0.0 ? 1.0F : 2.0F, 0.011F) << "beam " << i;
  }
}

std::vector<std::string> laser_names() {
  std::vector<std::string> names;
  for (const LaserModel& model : laser_models()) names.emplace_back(model.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, EachLaserModel, testing::ValuesIn(laser_names()),
                         [](const auto& laser) { return laser.param; });

}  // namespace
}  // namespace topogeo::devices
