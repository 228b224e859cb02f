// A port of the gateway that is a TCP connection to a simulated device.
#include <mutex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "serial_port.hpp"
#include "simulator/tcp_port.hpp"
#include "waiting.hpp"

namespace topogeo::sensor_gateway {
namespace {

using simulator::TcpPort;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using Kind = PortEvent::Kind;

class NetworkPortTest : public testing::Test {
 protected:
  void open() {
    port_ = std::make_unique<SerialPort>(
        PortOptions{"tcp://127.0.0.1:" + std::to_string(device_.port()), milliseconds(5),
                    milliseconds(20)},
        [this](PortEvent event) {
          const std::scoped_lock lock(mutex_);
          events_.push_back(std::move(event));
        });
  }

  [[nodiscard]] std::size_t count(Kind kind) {
    const std::scoped_lock lock(mutex_);
    return static_cast<std::size_t>(std::ranges::count(events_, kind, &PortEvent::kind));
  }

  [[nodiscard]] PortEvent last(Kind kind) {
    const std::scoped_lock lock(mutex_);
    for (auto event = events_.rbegin(); event != events_.rend(); ++event) {
      if (event->kind == kind) return *event;
    }
    return {};
  }

  /// Waits for an event, while the device accepts and reads.
  bool wait_for_event(const char* what, Kind kind, std::size_t number) {
    return test::wait_for(what, [&] {
      if (device_.plugged()) {
        for (const std::uint8_t byte : device_.receive()) received_.push_back(byte);
      }
      return count(kind) >= number;
    });
  }

  TcpPort device_{"127.0.0.1", 0};
  std::mutex mutex_;
  std::vector<PortEvent> events_;
  std::vector<std::uint8_t> received_;
  std::unique_ptr<SerialPort> port_;
};

TEST_F(NetworkPortTest, BytesGoBothWaysAndALineChangesNothing) {
  device_.plug();
  open();
  ASSERT_TRUE(wait_for_event("the connection", Kind::kOpened, 1));
  const std::uint64_t epoch = port_->epoch();
  port_->write({{devices::LineSettings{38'400, devices::Parity::kEven}, {'h', 'i'}, true}},
               last(Kind::kOpened).epoch);
  ASSERT_TRUE(wait_for_event("the bytes to leave", Kind::kWritten, 1));
  EXPECT_TRUE(test::wait_for("the bytes to arrive", [&] {
    for (const std::uint8_t byte : device_.receive()) received_.push_back(byte);
    return received_.size() == 2;
  }));
  EXPECT_THAT(received_, ElementsAre('h', 'i'));
  EXPECT_EQ(port_->epoch(), epoch);
  const std::vector<std::uint8_t> reply{0, 13, 10, 255};
  EXPECT_EQ(device_.send(reply), 0U);
  ASSERT_TRUE(wait_for_event("the reply", Kind::kBytes, 1));
  EXPECT_EQ(last(Kind::kBytes).bytes, reply);
}

TEST_F(NetworkPortTest, ADeviceThatGoesAndReturnsIsConnectedAgain) {
  device_.plug();
  open();
  ASSERT_TRUE(wait_for_event("the connection", Kind::kOpened, 1));
  ASSERT_TRUE(test::wait_for("the device to accept it", [&] {
    (void)device_.receive();
    return device_.host(devices::Parity::kNone).baud > 0;
  }));
  device_.unplug();
  ASSERT_TRUE(wait_for_event("the loss", Kind::kLost, 1));
  EXPECT_THAT(last(Kind::kLost).why, HasSubstr("127.0.0.1"));
  ASSERT_TRUE(wait_for_event("a refusal", Kind::kNotOpened, 1));
  EXPECT_THAT(last(Kind::kNotOpened).why, HasSubstr("cannot open: Connection refused"));
  device_.plug();
  EXPECT_TRUE(wait_for_event("the connection", Kind::kOpened, 2));
}

TEST_F(NetworkPortTest, AnAddressWithoutAPortIsAMistake) {
  EXPECT_THROW(SerialPort({"tcp://127.0.0.1"}, [](const PortEvent&) {}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::sensor_gateway
