// Halts and resets of a gateway, also while it ends: the next gateway obeys them.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/msg/motion.h"

#include "messaging/fixture.hpp"
#include "sensor_gateway/device_gateway.hpp"
#include "sensor_gateway/stop_memory.hpp"

namespace topogeo::sensor_gateway {
namespace {

namespace fs = std::filesystem;

service::Setup gateway_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "sensor_gateway";
  setup.options.partition = partition;
  return setup;
}

DeviceConfig base_without_port() {
  DeviceConfig config;
  config.base_port = "/nowhere/at/all";
  return config;
}

class BaseStops : public testing::Test {
 protected:
  BaseStops() {
    fs::create_directories(folder_);
    gateway_.emplace(service_, base_without_port(), 0, folder_ / "memory");
  }
  ~BaseStops() override {
    gateway_.reset();
    fs::remove_all(folder_);
  }

  /// Returns when the middleware of the gateway has the command; no handler has run.
  void send(msg::BaseCommandKind kind) {
    auto command = messaging::message<msg::BaseCommand>();
    command.kind(kind);
    ASSERT_TRUE(messaging::wait_for_peers(commands_) && commands_.write(command) &&
                messaging::wait_for_acknowledgments(commands_));
  }
  [[nodiscard]] bool next_gateway_is_halted() const {
    return StopMemory(folder_ / "memory.stops").held().halt;
  }

  std::string partition_ = messaging::random_partition();
  fs::path folder_ = fs::path(testing::TempDir()) / ("base_stops_" + partition_);
  service::Service service_{gateway_setup(partition_)};
  std::optional<DeviceGateway> gateway_;
  messaging::Participant operator_{messaging::options_in(partition_)};
  messaging::Writer<msg::BaseCommand> commands_{operator_};
};

TEST_F(BaseStops, TheEndOfTheGatewayIsNoHalt) {
  gateway_->finish();
  EXPECT_FALSE(next_gateway_is_halted());
}

TEST_F(BaseStops, AHaltThatArrivesWhileTheGatewayEndsHolds) {
  send(msg::kBaseHalt);
  gateway_->finish();
  EXPECT_TRUE(next_gateway_is_halted());
}

TEST_F(BaseStops, AHaltThatIsHandledAfterTheEndHolds) {
  gateway_->finish();
  send(msg::kBaseHalt);
  static_cast<void>(service_.loop().run_for(std::chrono::milliseconds::zero()));
  EXPECT_TRUE(next_gateway_is_halted());
}

}  // namespace
}  // namespace topogeo::sensor_gateway
