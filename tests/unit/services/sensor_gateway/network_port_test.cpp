// A port of the gateway that is a TCP connection to a simulated device.
#include <mutex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/devices/envelope.hpp"

#include "serial_port.hpp"
#include "simulator/datagram_port.hpp"
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

/// A port with datagrams, and the simulated device behind it.
class DatagramPortTest : public testing::Test {
 protected:
  DatagramPortTest() {
    device_.plug();
    port_ = std::make_unique<SerialPort>(
        PortOptions{"udp://127.0.0.1:" + std::to_string(device_.port()), milliseconds(5),
                    milliseconds(20)},
        [this](const PortEvent& event) {
          const std::scoped_lock lock(mutex_);
          if (event.kind == Kind::kOpened) epoch_ = event.epoch;
          if (event.kind != Kind::kBytes) return;
          for (devices::Envelope& envelope : reader_.read(event.bytes)) {
            envelopes_.push_back(std::move(envelope));
          }
        });
  }

  void say(devices::EnvelopeKind kind, const std::string& text) {
    std::vector<std::uint8_t> bytes;
    devices::put_envelope(bytes, kind, std::vector<std::uint8_t>(text.begin(), text.end()));
    EXPECT_EQ(device_.send(bytes), 0U);
  }

  /// Contents of the envelopes of a kind.
  [[nodiscard]] std::vector<std::string> received(devices::EnvelopeKind kind) {
    const std::scoped_lock lock(mutex_);
    std::vector<std::string> texts;
    for (const devices::Envelope& envelope : envelopes_) {
      if (envelope.kind != kind) continue;
      texts.emplace_back(envelope.contents.begin(), envelope.contents.end());
    }
    return texts;
  }

  void command() {
    const std::scoped_lock lock(mutex_);
    port_->write({{{}, {'g', 'o'}, {}}}, epoch_);
  }

  [[nodiscard]] bool command_arrives() {
    command();
    return test::wait_for("the command", [this] { return !device_.receive().empty(); });
  }

  simulator::DatagramPort device_{"127.0.0.1", 0};
  std::mutex mutex_;
  devices::EnvelopeReader reader_;
  std::vector<devices::Envelope> envelopes_;
  std::uint64_t epoch_ = 0;
  std::unique_ptr<SerialPort> port_;
};

TEST_F(DatagramPortTest, TheAddressComesFirstThenRepliesAndWholeDatagrams) {
  using devices::EnvelopeKind;
  ASSERT_TRUE(
      test::wait_for("the address", [this] { return received(EnvelopeKind::kHost).size() == 1; }));
  const std::string host = received(EnvelopeKind::kHost).front();
  EXPECT_THAT(host, HasSubstr("127.0.0.1:"));
  ASSERT_TRUE(command_arrives());
  say(EnvelopeKind::kHost, host);
  say(EnvelopeKind::kReply, "ok");
  const std::string large(9000, 'x');
  say(EnvelopeKind::kDatagram, large);
  say(EnvelopeKind::kDatagram, "small");
  ASSERT_TRUE(test::wait_for("the data", [this] {
    return received(EnvelopeKind::kDatagram).size() == 2 && !received(EnvelopeKind::kReply).empty();
  }));
  EXPECT_THAT(received(EnvelopeKind::kDatagram), ElementsAre(large, "small"));
  EXPECT_THAT(received(EnvelopeKind::kReply), ElementsAre("ok"));
}

TEST_F(DatagramPortTest, AConnectionThatTheDeviceClosesIsOpenedForTheNextCommand) {
  using devices::EnvelopeKind;
  ASSERT_TRUE(
      test::wait_for("the address", [this] { return received(EnvelopeKind::kHost).size() == 1; }));
  ASSERT_TRUE(command_arrives());
  device_.unplug();
  device_.plug();
  EXPECT_TRUE(test::wait_for("a command over a new connection", [this] {
    command();
    return !device_.receive().empty();
  }));
}

}  // namespace
}  // namespace topogeo::sensor_gateway
