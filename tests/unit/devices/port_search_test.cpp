// The search for a device on a port, against the emulator of each laser and base.
#include "topogeo/devices/port_search.hpp"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/support/random.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kSearchSecond_ns = 1'000'000'000;
constexpr std::int64_t kLongestSearch_ns = 60 * kSearchSecond_ns;

std::vector<float> walls_at_1_m(const simulation::BeamPattern& beams, std::int64_t /*now_ns*/) {
  return std::vector<float>(beams.count, 1.0F);
}

/// Runs the search to its end and returns all bytes that it wrote.
std::vector<std::uint8_t> search(PortSearch& port, simulation::SerialDevice& device) {
  SimulatedLine line(port, device, kSearchSecond_ns);
  std::vector<std::uint8_t> written;
  line.set_host_filter([&](std::vector<std::uint8_t>& bytes) {
    written.insert(written.end(), bytes.begin(), bytes.end());
  });
  line.plug_in();
  EXPECT_TRUE(line.run_until(kLongestSearch_ns, [&] { return port.done(); }));
  line.run_for(kSearchSecond_ns);
  return written;
}

std::unique_ptr<simulation::LaserEmulator> emulated(const LaserModel& model) {
  simulation::LaserEmulatorSettings settings;
  settings.model = &model;
  return simulation::make_laser_emulator(settings, walls_at_1_m);
}

bool sends_by_itself(const LaserModel& model) {
  return model.family.starts_with("ldrobot") || model.family == "xv11" ||
         model.family == "ydlidar_one_way";
}

/// It has no serial port.
bool on_network(const LaserModel& model) {
  return model.family == "cola" || model.name.starts_with("ust");
}

class EachLaserOnAPort : public testing::TestWithParam<std::string> {};

TEST_P(EachLaserOnAPort, IsFoundAndAskedOnlyIfItIsSilent) {
  const LaserModel& model = laser_model(GetParam());
  const auto laser = emulated(model);
  PortSearch port(true, on_network(model) ? PortSearch::Link::kNetwork : PortSearch::Link::kSerial);
  const std::vector<std::uint8_t> written = search(port, *laser);
  if (model.name == "lds01") {  // its start letter would move some bases
    EXPECT_FALSE(port.device());
    EXPECT_EQ(port.why_none(), "sends nothing and answers no question");
    return;
  }
  ASSERT_TRUE(port.device()) << port.why_none();
  EXPECT_EQ(port.device()->kind, DeviceKind::kLaser);
  EXPECT_EQ(port.device()->model, model.name == "ld06" ? "ld19" : model.name);
  const bool any_rate = model.family == "scip" || model.family == "cola";
  if (model.name != "sick_pls" && !any_rate) {
    EXPECT_EQ(port.device()->line, model.line);
  }
  EXPECT_EQ(port.asked(), !sends_by_itself(model));
  EXPECT_EQ(written.empty(), sends_by_itself(model));
  EXPECT_EQ(port.device()->device.empty(), sends_by_itself(model));
}

/// A laser that sends datagrams is not searched for.
std::vector<std::string> names_of_lasers() {
  std::vector<std::string> names;
  for (const LaserModel& model : laser_models()) {
    if (!sends_datagrams(model)) names.emplace_back(model.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, EachLaserOnAPort, testing::ValuesIn(names_of_lasers()),
                         [](const auto& laser) { return laser.param; });

class EachScanningLaser : public testing::TestWithParam<std::string> {};

TEST_P(EachScanningLaser, IsHeardWithoutAQuestion) {
  const LaserModel& model = laser_model(GetParam());
  const auto laser = emulated(model);
  LaserSettings settings;
  settings.model = &model;
  const auto driver = make_laser_driver(settings);
  SimulatedLine line(*driver, *laser);
  line.plug_in();
  ASSERT_TRUE(line.run_until(30 * kSearchSecond_ns,
                             [&] { return driver->health().state == LaserState::kRunning; }));
  // The program is killed, and its port closed.
  PortSearch port;
  SimulatedLine later(port, *laser, line.now_ns());
  later.plug_in();
  ASSERT_TRUE(later.run_until(kLongestSearch_ns, [&] { return port.done(); }));
  ASSERT_TRUE(port.device()) << port.why_none();
  EXPECT_FALSE(port.asked());
  const std::map<std::string, std::string> same{
      {"rplidar_a1", "rplidar_a2"}, {"rplidar_s1", "rplidar_a3"}, {"ust_20lx", "utm_30lx"}};
  const auto alike = same.find(GetParam());
  EXPECT_EQ(port.device()->model, alike == same.end() ? GetParam() : alike->second);
  EXPECT_EQ(port.device()->note.empty(), !GetParam().starts_with("rplidar_a") &&
                                             GetParam() != "rplidar_s1" &&
                                             GetParam() != "ust_20lx");
}

INSTANTIATE_TEST_SUITE_P(All, EachScanningLaser,
                         testing::Values("sick_pls", "lds01", "rplidar_a1", "rplidar_a2",
                                         "rplidar_a3", "rplidar_s1", "rplidar_s2", "rplidar_c1",
                                         "ydlidar_x4", "ydlidar_g4", "ydlidar_tg", "urg_04lx",
                                         "ust_20lx"),
                         [](const auto& laser) { return laser.param; });

class EachBaseOnAPort : public testing::TestWithParam<std::string> {};

TEST_P(EachBaseOnAPort, NeverMoves) {
  const BaseModel& model = base_model(GetParam());
  const bool speaks = model.family == "text" || model.family == "kobuki";
  for (const std::uint32_t baud : {9'600U, 38'400U, 57'600U, 115'200U}) {
    simulation::BaseEmulatorSettings settings;
    settings.model = &model;
    settings.baud = baud;
    const auto base = simulation::make_base_emulator(settings, kSearchSecond_ns);
    PortSearch port;
    SimulatedLine line(port, *base, kSearchSecond_ns);
    std::size_t written = 0;
    line.set_host_filter([&](std::vector<std::uint8_t>& bytes) { written += bytes.size(); });
    line.plug_in();
    const bool over = line.run_until(kLongestSearch_ns, [&] {
      const geometry::Velocity velocity = base->commanded_velocity();
      EXPECT_EQ(velocity.linear_m_per_s, 0.0);
      EXPECT_EQ(velocity.angular_rad_per_s, 0.0);
      return port.done() || HasFailure();
    });
    ASSERT_TRUE(over);
    ASSERT_EQ(port.device().has_value(), speaks) << baud << ": " << port.why_none();
    if (!speaks) {
      // It obeys no question at any rate. An RWI base shows its own rate by its echo, and so does a
      // Roboteq.
      const bool echoes = (model.family == "rwi" || model.family == "roboteq") && baud != 57'600;
      EXPECT_EQ(port.why_none(),
                !echoes ? "sends nothing and answers no question"
                        : "echoes what it receives, as an RWI B21 does (base.model: rwi_b21)");
      continue;
    }
    EXPECT_EQ(written, 0U);
    EXPECT_EQ(port.device()->kind, DeviceKind::kBase);
    EXPECT_EQ(port.device()->model, model.name);
    EXPECT_EQ(port.device()->line.baud, baud);
  }
}

class EachBaseThatReportsOn : public testing::TestWithParam<std::string> {};

// It may move, and is not asked.
TEST_P(EachBaseThatReportsOn, IsHeardAfterItsProgramWasKilled) {
  simulation::BaseEmulatorSettings emulated_base;
  emulated_base.model = &base_model(GetParam());
  emulated_base.baud = 115'200;
  const auto base = simulation::make_base_emulator(emulated_base);
  BaseSettings settings;
  settings.model = emulated_base.model;
  settings.line.baud = emulated_base.baud;
  const auto driver = make_base_driver(settings);
  SimulatedLine line(*driver, *base);
  line.plug_in();
  ASSERT_TRUE(
      line.run_until(30 * kSearchSecond_ns, [&] { return driver->status().commands_taken; }));
  PortSearch port;
  SimulatedLine later(port, *base, line.now_ns());
  std::size_t written = 0;
  later.set_host_filter([&](std::vector<std::uint8_t>& bytes) { written += bytes.size(); });
  later.plug_in();
  ASSERT_TRUE(later.run_until(kLongestSearch_ns, [&] { return port.done(); }));
  ASSERT_TRUE(port.device()) << port.why_none();
  EXPECT_EQ(port.device()->model, GetParam());
  EXPECT_FALSE(port.asked());
  EXPECT_EQ(written, 0U);
}

INSTANTIATE_TEST_SUITE_P(All, EachBaseThatReportsOn, testing::Values("create2", "pioneer"),
                         [](const auto& base) { return base.param; });

std::vector<std::string> names_of_bases() {
  std::vector<std::string> names;
  for (const BaseModel& model : base_models()) names.emplace_back(model.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, EachBaseOnAPort, testing::ValuesIn(names_of_bases()),
                         [](const auto& base) { return base.param; });

/// Sends random bytes, ten times a second.
class UnknownDevice final : public simulation::SerialDevice {
 public:
  void receive(std::span<const std::uint8_t> /*bytes*/, const LineSettings& /*host*/,
               std::int64_t /*now_ns*/) override {}
  void tick(std::int64_t now_ns) override { next_ns_ = now_ns + 100'000'000; }
  [[nodiscard]] std::int64_t due_ns() const override { return next_ns_; }
  [[nodiscard]] std::vector<std::uint8_t> take_output(const LineSettings& /*host*/,
                                                      std::int64_t now_ns) override {
    std::vector<std::uint8_t> bytes;
    for (; sent_ns_ + 100'000'000 < now_ns; sent_ns_ += 100'000'000) {
      for (int i = 0; i < 100; ++i) bytes.push_back(static_cast<std::uint8_t>(random_.below(256)));
    }
    return bytes;
  }

 private:
  support::Random random_{7};
  std::int64_t next_ns_ = 0;
  std::int64_t sent_ns_ = kSearchSecond_ns;
};

TEST(PortSearch, NeverAsksADeviceThatSendsSomethingUnknown) {
  UnknownDevice device;
  PortSearch port;
  EXPECT_TRUE(search(port, device).empty());
  EXPECT_FALSE(port.device());
  EXPECT_TRUE(port.why_none().starts_with("sends ")) << port.why_none();
  EXPECT_TRUE(port.why_none().ends_with(" bytes that no driver knows")) << port.why_none();
}

TEST(PortSearch, OnlyListensIfTold) {
  const auto laser = emulated(laser_model("rplidar_a2"));
  PortSearch port(false);
  EXPECT_TRUE(search(port, *laser).empty());
  EXPECT_FALSE(port.device());
  EXPECT_EQ(port.why_none(), "sends nothing, and was not asked");
}

TEST(PortSearch, PressesNoButtonThatMovesARoomba) {
  const auto nobody = emulated(laser_model("rplidar_a2"));
  nobody->switch_off();
  PortSearch port;
  const std::vector<std::uint8_t> written = search(port, *nobody);
  ASSERT_FALSE(written.empty());
  // iRobot Create 2 Open Interface: numbers from 128 on are orders, "Buttons" has one byte of data.
  constexpr std::uint8_t kFirstOrder = 128;
  constexpr std::uint8_t kButtons = 165;
  constexpr std::uint8_t kCleanSpotOrDock = 0x07;
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (written[i] < kFirstOrder) continue;
    ASSERT_EQ(written[i], kButtons) << i;
    ASSERT_LT(++i, written.size());
    EXPECT_EQ(written[i] & kCleanSpotOrDock, 0) << i;
  }
}

TEST(PortSearch, BeginsAgainWhenThePortReturns) {
  const auto laser = emulated(laser_model("ld19"));
  PortSearch port;
  SimulatedLine line(port, *laser);
  line.plug_in();
  line.run_for(kSearchSecond_ns);
  line.unplug();
  line.run_for(10 * kSearchSecond_ns);
  EXPECT_FALSE(port.done());
  line.plug_in();
  EXPECT_TRUE(line.run_until(kLongestSearch_ns, [&] { return port.done(); }));
  EXPECT_TRUE(port.device());
}

}  // namespace
}  // namespace topogeo::devices
