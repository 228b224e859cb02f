// topogeo devices: finds emulated devices on their pseudo-terminals, and writes the devices file.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/laser_models.hpp"

#include "command_test.hpp"
#include "device_config.hpp"
#include "tcp_port.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class DevicesCommandTest : public CommandTest {
 protected:
  DevicesCommandTest() : CommandTest("devices") { use_udp_only(); }

  void simulate(const std::string& laser, const std::string& base, const std::string& baud) {
    simulator_ = std::make_unique<Program>(
        scratch_, "simulator",
        std::vector<std::string>{"--domain", own_domain(), "--world",
                                 std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml",
                                 "--laser-port", laser_, "--base-port", base_, "--laser-model",
                                 laser, "--base-model", base, "--base-baud", baud});
    ASSERT_TRUE(wait_for("both ports", [&] {
      return (laser_.starts_with("tcp:") || fs::exists(laser_)) && fs::exists(base_);
    })) << simulator_->err();
  }

  /// Searches until all is found: on a busy machine an answer may come too late.
  bool finds(const std::vector<std::string>& words, const std::vector<std::string>& all) {
    return wait_for(
        "the devices", [&] { return run(words) == 0 && has_all(all); }, [] {});
  }

  bool has_all(const std::vector<std::string>& texts) const {
    return std::ranges::all_of(
        texts, [&](const std::string& text) { return out_.find(text) != std::string::npos; });
  }

  std::string laser_ = scratch_ / "laser.port";
  std::string base_ = scratch_ / "base.port";
  std::string file_ = scratch_ / "devices.yaml";
  std::unique_ptr<Program> simulator_;
};

TEST_F(DevicesCommandTest, FindsALaserAndABaseThatSendByThemselves) {
  simulate("ld19", "microcontroller", "57600");
  ASSERT_TRUE(
      finds({laser_, base_, "--write", file_, "--force"}, {"LDROBOT LD19", "sends at 57600 baud"}))
      << out_ << err_;
  const sensor_gateway::DeviceConfig config = sensor_gateway::load_devices(file_);
  EXPECT_EQ(config.laser_port, laser_);
  EXPECT_EQ(config.laser.model->name, "ld19");
  EXPECT_EQ(config.base_port, base_);
  EXPECT_EQ(config.base.model->name, "microcontroller");
  EXPECT_EQ(config.base.line.baud, 57'600U);
  const std::string written = read_file(file_);
  EXPECT_EQ(run({laser_, "--write", file_}), 2);
  EXPECT_THAT(err_, HasSubstr("exists already; --force replaces it"));
  EXPECT_EQ(read_file(file_), written);
}

TEST_F(DevicesCommandTest, AsksASilentLaserAndReportsASilentBase) {
  simulate("rplidar_a2", "rwi_b21", "9600");
  ASSERT_TRUE(finds({laser_, base_, "--json"}, {"\"model\": \"rplidar_a2\"", "\"asked\": true",
                                                "echoes what it receives, as an RWI B21 does"}))
      << out_ << err_;
  EXPECT_EQ(run({laser_, "--listen-only"}), 1);
  EXPECT_THAT(out_, HasSubstr("was not asked"));
}

/// A port that no program has now.
std::string free_port() {
  simulator::TcpPort port("127.0.0.1", 0);
  port.plug();
  return std::to_string(port.port());
}

TEST_F(DevicesCommandTest, FindsALaserOnTheNetwork) {
  const std::string address = "tcp://127.0.0.1:" + free_port();
  laser_ = address;
  simulate("ust_20lx", "microcontroller", "57600");
  ASSERT_TRUE(finds({address, "--write", file_, "--force"}, {"Hokuyo UST-20LX, answers"}))
      << out_ << err_;
  const sensor_gateway::DeviceConfig config = sensor_gateway::load_devices(file_);
  EXPECT_EQ(config.laser_port, address);
  EXPECT_EQ(config.laser.model->name, "ust_20lx");
}

TEST_F(DevicesCommandTest, ReportsPortsThatCannotBeSearched) {
  std::ofstream(scratch_ / "file").flush();
  EXPECT_EQ(run({(scratch_ / "file").string(), (scratch_ / "none").string(), "--write", file_}), 1);
  EXPECT_THAT(out_, HasSubstr("not a serial port"));
  EXPECT_THAT(out_, HasSubstr("No such file or directory"));
  EXPECT_FALSE(fs::exists(file_));
}

}  // namespace
}  // namespace topogeo::test
