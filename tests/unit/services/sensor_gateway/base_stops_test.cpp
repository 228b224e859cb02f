// Halts and resets of a gateway, also while it ends: the next gateway obeys them.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"

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
  void send(msg::BaseCommandKind kind) { send(commands_, kind, 0); }
  static void send(messaging::Writer<msg::BaseCommand>& writer, msg::BaseCommandKind kind,
                   std::uint64_t stop_count) {
    auto command = messaging::message<msg::BaseCommand>();
    command.kind(kind);
    command.stop_count(stop_count);
    ASSERT_TRUE(messaging::wait_for_peers(writer) && writer.write(command) &&
                messaging::wait_for_acknowledgments(writer));
  }
  /// Runs the gateway until its status names another stop than `previous`, and returns its number.
  std::uint64_t next_stop_count(std::uint64_t previous) {
    std::uint64_t count = previous;
    EXPECT_TRUE(test::wait_in_loop(service_.loop(), "a status after the next stop", [&] {
      statuses_.take([&](const msg::BaseStatus& status, const messaging::SampleInfo& info) {
        if (info.valid) count = status.stop_count();
      });
      return count != previous;
    }));
    return count;
  }
  void run_gateway() {
    static_cast<void>(service_.loop().run_for(std::chrono::milliseconds::zero()));
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
  messaging::Reader<msg::BaseStatus> statuses_{operator_};
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
  run_gateway();
  EXPECT_TRUE(next_gateway_is_halted());
}

// A cut link delivers the reset seconds after it was sent, and the other operator's halt at once.
TEST_F(BaseStops, AResetThatWasSentBeforeAHaltDoesNotReleaseIt) {
  const std::uint64_t none = next_stop_count(0);
  send(msg::kBaseHalt);
  const std::uint64_t first = next_stop_count(none);
  messaging::Writer<msg::BaseCommand> late(operator_);
  ASSERT_TRUE(messaging::wait_for_peers(late));
  send(msg::kBaseHalt);
  const std::uint64_t second = next_stop_count(first);
  for (const std::uint64_t seen : {std::uint64_t{0}, first}) {
    send(late, msg::kBaseReset, seen);
    run_gateway();
    EXPECT_TRUE(next_gateway_is_halted()) << seen;
  }
  send(late, msg::kBaseReset, second);
  run_gateway();
  EXPECT_FALSE(next_gateway_is_halted());
}

}  // namespace
}  // namespace topogeo::sensor_gateway
