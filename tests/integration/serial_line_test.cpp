// A driver on a pseudo-terminal that is unplugged and plugged in again.
#include "serial_line.hpp"

#include <limits>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/support/host.hpp"

#include "program.hpp"
#include "test_port.hpp"

namespace topogeo::sensor_gateway {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;
using Bytes = std::vector<std::uint8_t>;

/// Keeps received bytes and sends those that the test queues.
class NotingDriver final : public devices::SerialDriver {
 public:
  void opened(std::int64_t now_ns) override {
    note(now_ns);
    ++opened_;
    orders_ = {{devices::LineSettings{38'400, devices::Parity::kEven}, {'h', 'i'}}};
  }
  void lost(std::int64_t now_ns) override {
    note(now_ns);
    ++lost_;
    received_.clear();
  }
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override {
    note(now_ns);
    received_.insert(received_.end(), bytes.begin(), bytes.end());
  }
  void tick(std::int64_t now_ns) override {
    note(now_ns);
    ++ticks_;
    due_ns_ = std::numeric_limits<std::int64_t>::max();
  }
  [[nodiscard]] std::int64_t due_ns() const override { return due_ns_; }
  [[nodiscard]] std::vector<devices::LineOrder> take_orders() override {
    return std::exchange(orders_, {});
  }

  int opened_ = 0;
  int lost_ = 0;
  int ticks_ = 0;
  Bytes received_;
  std::vector<devices::LineOrder> orders_;
  std::int64_t due_ns_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_ns_ = 0;
  bool time_went_back_ = false;

 private:
  void note(std::int64_t now_ns) {
    time_went_back_ = time_went_back_ || now_ns < last_ns_;
    last_ns_ = now_ns;
  }
};

class SerialLineTest : public testing::Test {
 protected:
  ~SerialLineTest() override { EXPECT_FALSE(driver_.time_went_back_); }

  void start(const Bytes& stop_bytes = {}) {
    PortOptions options{terminal_.link().string(), milliseconds(5), milliseconds(20)};
    options.stop_bytes = stop_bytes;
    options.stop_after = milliseconds(1);
    line_.emplace(loop_, driver_, options, [this](std::int64_t) { ++calls_; });
  }

  template <class Condition>
  bool wait_for(const std::string& what, const Condition& condition) {
    return test::wait_in_loop(loop_, what, condition);
  }

  /// Receives bytes at the far end until there are as many as expected.
  Bytes arriving(std::size_t size) {
    Bytes bytes;
    EXPECT_TRUE(wait_for("bytes at the far end", [&] {
      const Bytes more = terminal_.receive();
      bytes.insert(bytes.end(), more.begin(), more.end());
      return bytes.size() >= size;
    }));
    return bytes;
  }

  test::Scratch scratch_;
  test::TestPort terminal_{scratch_ / "port"};
  messaging::EventLoop loop_;
  NotingDriver driver_;
  int calls_ = 0;
  std::optional<SerialLine> line_;
};

TEST_F(SerialLineTest, BytesGoBothWaysAndSettingsTakeEffect) {
  terminal_.plug();
  start();
  EXPECT_THAT(arriving(2), ElementsAre('h', 'i'));
  EXPECT_EQ(driver_.opened_, 1);
  EXPECT_TRUE(line_->is_open());
  EXPECT_EQ(terminal_.speed(), speed_t{B38400});
  terminal_.send({0x00, 0x0D, 0x0A, 0x11, 0x13, 0x03, 0xFF});  // none is special here
  EXPECT_TRUE(wait_for("bytes of the far end", [&] { return driver_.received_.size() >= 7; }));
  EXPECT_THAT(driver_.received_, ElementsAre(0x00, 0x0D, 0x0A, 0x11, 0x13, 0x03, 0xFF));
  EXPECT_GE(calls_, 2);
}

TEST_F(SerialLineTest, OrdersAreCarriedOutInTheirOrder) {
  terminal_.plug();
  start();
  ASSERT_EQ(arriving(2).size(), 2U);
  Bytes expected;
  for (std::uint8_t i = 0; i < 200; ++i) {
    devices::LineOrder order;
    if (i % 3 == 0) order.settings = devices::LineSettings{i % 2 == 0 ? 500'000U : 9600U};
    order.bytes.assign(i % 5, i);  // some orders have only settings, some nothing
    expected.insert(expected.end(), order.bytes.begin(), order.bytes.end());
    driver_.orders_.push_back(order);
  }
  line_->carry_out();
  EXPECT_EQ(arriving(expected.size()), expected);
  EXPECT_TRUE(line_->wait_written(test::hang_limit()));
  EXPECT_EQ(terminal_.speed(), speed_t{B500000});  // of order 198
}

// The program is not killed here, but gives no more orders, like one that is frozen.
TEST_F(SerialLineTest, APortWithoutOrdersGetsTheOrderToStop) {
  terminal_.plug();
  start({'s'});
  EXPECT_THAT(arriving(3), UnorderedElementsAre('h', 'i', 's'));
  terminal_.unplug();
  EXPECT_TRUE(wait_for("the loss", [&] { return driver_.lost_ == 1; }));
  terminal_.plug();
  EXPECT_THAT(arriving(3), UnorderedElementsAre('h', 'i', 's')) << "a new process for a new port";
}

// Otherwise a device would be reported silent only because the gateway got no CPU time.
TEST_F(SerialLineTest, AfterStandingStillReadsBeforeTimeIsUp) {
  terminal_.plug();
  start();
  ASSERT_EQ(arriving(2).size(), 2U);
  driver_.due_ns_ = support::monotonic_ns() + 10'000'000;
  line_->carry_out();
  std::this_thread::sleep_for(milliseconds(100));  // blocks the loop, as on a busy machine
  const std::int64_t back_ns = support::monotonic_ns();
  ASSERT_TRUE(wait_for("the tick", [&] { return driver_.ticks_ > 0; }));
  EXPECT_GE(driver_.last_ns_ - back_ns, 10'000'000);
}

TEST_F(SerialLineTest, UnpluggedAndPluggedInAgainFiveTimes) {
  start();  // before the port exists
  ASSERT_TRUE(wait_for("two attempts to open the port",
                       [&] { return line_->statistics().not_opened >= 2; }));
  EXPECT_THAT(line_->why_closed(),
              AllOf(HasSubstr(terminal_.link().string()), HasSubstr("No such file")));
  for (int i = 1; i <= 5; ++i) {
    terminal_.plug();
    ASSERT_EQ(arriving(2).size(), 2U);
    terminal_.send({'x'});
    ASSERT_TRUE(wait_for("a byte of the far end", [&] { return driver_.received_ == Bytes{'x'}; }));
    EXPECT_EQ(driver_.opened_, i);
    EXPECT_TRUE(line_->why_closed().empty());
    terminal_.unplug();
    ASSERT_TRUE(wait_for("the loss of the port", [&] { return driver_.lost_ == i; }));
    EXPECT_FALSE(line_->is_open());
    EXPECT_THAT(line_->why_closed(), HasSubstr(terminal_.link().string()));
  }
  EXPECT_EQ(line_->statistics().opened, 5U);
  EXPECT_EQ(line_->statistics().lost, 5U);
  driver_.orders_ = {{{}, {'n', 'o'}}};
  line_->carry_out();  // to a missing port: dropped
  EXPECT_TRUE(line_->wait_written(test::hang_limit()));
}

TEST_F(SerialLineTest, DriverIsCalledWhenItIsDue) {
  start();
  driver_.due_ns_ = support::monotonic_ns() + 3'000'000;
  line_->carry_out();
  EXPECT_TRUE(wait_for("the first tick", [&] { return driver_.ticks_ == 1; }));
  driver_.due_ns_ = support::monotonic_ns() + 3'600'000'000'000;  // first in an hour, then sooner
  line_->carry_out();
  driver_.due_ns_ = support::monotonic_ns();
  line_->carry_out();
  EXPECT_TRUE(wait_for("the second tick", [&] { return driver_.ticks_ == 2; }));
}

TEST_F(SerialLineTest, SecondProgramOnThePortIsTold) {
  terminal_.plug();
  start();
  ASSERT_EQ(arriving(2).size(), 2U);
  NotingDriver other_driver;
  SerialLine other(loop_, other_driver,
                   PortOptions{terminal_.link().string(), milliseconds(5), milliseconds(20)}, {});
  EXPECT_TRUE(
      wait_for("an attempt to open the port", [&] { return other.statistics().not_opened > 0; }));
  EXPECT_THAT(other.why_closed(), HasSubstr("busy"));
}

TEST_F(SerialLineTest, WhatIsNoSerialPortIsNamed) {
  for (const std::string path : {"/dev/null", "/tmp"}) {
    SerialLine line(loop_, driver_, PortOptions{path, milliseconds(5), milliseconds(20)}, {});
    EXPECT_TRUE(
        wait_for("an attempt to open the port", [&] { return line.statistics().not_opened > 0; }));
    EXPECT_THAT(line.why_closed(), AllOf(HasSubstr(path), HasSubstr("cannot open")));
  }
  EXPECT_EQ(driver_.opened_, 0);
}

TEST_F(SerialLineTest, MistakesAreErrors) {
  EXPECT_THROW(SerialLine(loop_, driver_, PortOptions{""}, {}), std::invalid_argument);
  EXPECT_THROW(SerialLine(loop_, driver_, PortOptions{"/dev/x", milliseconds(0)}, {}),
               std::invalid_argument);
  EXPECT_THROW(
      SerialLine(loop_, driver_, PortOptions{"/dev/x", milliseconds(5), milliseconds(4)}, {}),
      std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::sensor_gateway
