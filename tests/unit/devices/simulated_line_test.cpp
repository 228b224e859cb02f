#include "simulated_line.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/simulation/serial_output.hpp"

namespace topogeo::devices {
namespace {

using LineBytes = std::vector<std::uint8_t>;
constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr LineSettings kFast{38400, Parity::kEven};

/// Sends "abc" with new settings when it is opened and records all its events.
class Caller final : public SerialDriver {
 public:
  void opened(std::int64_t now_ns) override {
    opened_ns.push_back(now_ns);
    orders_.push_back({LineSettings{}, {'x'}});
    orders_.push_back({kFast, {'a', 'b', 'c'}});
  }
  void lost(std::int64_t now_ns) override { lost_ns.push_back(now_ns); }
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override {
    received.insert(received.end(), bytes.begin(), bytes.end());
    received_ns = now_ns;
  }
  void tick(std::int64_t now_ns) override {
    ticked_ns.push_back(now_ns);
    due = std::numeric_limits<std::int64_t>::max();
  }
  [[nodiscard]] std::int64_t due_ns() const override { return due; }
  [[nodiscard]] std::vector<LineOrder> take_orders() override { return std::exchange(orders_, {}); }

  std::int64_t due = 7;
  std::vector<std::int64_t> opened_ns;
  std::vector<std::int64_t> lost_ns;
  std::vector<std::int64_t> ticked_ns;
  LineBytes received;
  std::int64_t received_ns = 0;

 private:
  std::vector<LineOrder> orders_;
};

/// Echoes the bytes that it understands.
class Echo final : public simulation::SerialDevice {
 public:
  void receive(std::span<const std::uint8_t> bytes, const LineSettings& host,
               std::int64_t now_ns) override {
    heard_ns.push_back(now_ns);
    if (host == kFast) output.send({bytes.begin(), bytes.end()}, kFast, now_ns);
  }
  void tick(std::int64_t /*now_ns*/) override {}
  [[nodiscard]] std::int64_t due_ns() const override {
    return std::numeric_limits<std::int64_t>::max();
  }
  [[nodiscard]] LineBytes take_output(const LineSettings& host, std::int64_t now_ns) override {
    return output.take(host, now_ns);
  }

  simulation::SerialOutput output;
  std::vector<std::int64_t> heard_ns;
};

TEST(SimulatedLine, WritesAtTheRateOfThePortAndReadsWhatComesBack) {
  Caller caller;
  Echo echo;
  SimulatedLine line(caller, echo);
  line.plug_in();
  line.run_for(20 * kMillisecond_ns);
  EXPECT_EQ(caller.ticked_ns, (std::vector<std::int64_t>{7}));
  const std::int64_t first_ns = line_time_ns(1, {});
  const std::int64_t second_ns = first_ns + line_time_ns(3, kFast);
  EXPECT_EQ(echo.heard_ns, (std::vector<std::int64_t>{first_ns, second_ns}));
  EXPECT_EQ(caller.received, (LineBytes{'a', 'b', 'c'}));
  EXPECT_GE(caller.received_ns, second_ns + line_time_ns(3, kFast));
  EXPECT_LE(caller.received_ns, second_ns + line_time_ns(3, kFast) + SimulatedLine::kReadPeriod_ns);
}

TEST(SimulatedLine, LosesWhatIsOnItsWayWhenUnplugged) {
  Caller caller;
  Echo echo;
  SimulatedLine line(caller, echo);
  line.plug_in();
  line.run_for(line_time_ns(1, {}) + 1);
  line.unplug();
  line.run_for(20 * kMillisecond_ns);
  EXPECT_EQ(caller.lost_ns.size(), 1U);
  EXPECT_EQ(echo.heard_ns.size(), 1U);
  EXPECT_TRUE(caller.received.empty());
  line.plug_in();
  EXPECT_EQ(line.host(), LineSettings{});
  EXPECT_TRUE(line.run_until(20 * kMillisecond_ns, [&] { return caller.received.size() == 3; }));
  EXPECT_EQ(caller.opened_ns.size(), 2U);
}

TEST(SerialOutput, LeavesByteByByte) {
  simulation::SerialOutput output;
  const std::int64_t byte_ns = line_time_ns(1, kFast);
  EXPECT_EQ(output.send({1, 2, 3}, kFast, 1000), 1000 + line_time_ns(3, kFast));
  EXPECT_EQ(output.send({4}, kFast, 0), 1000 + line_time_ns(4, kFast));
  EXPECT_EQ(output.take(kFast, 1000), LineBytes{});
  EXPECT_EQ(output.take(kFast, 1000 + byte_ns), LineBytes{1});
  EXPECT_EQ(output.take(kFast, 1000 + byte_ns), LineBytes{});
  EXPECT_EQ(output.take(kFast, 1000 + 10 * byte_ns), (LineBytes{2, 3, 4}));
  output.send({5}, kFast, 0);
  output.clear();
  EXPECT_EQ(output.take(kFast, 1000 + 100 * byte_ns), LineBytes{});
}

TEST(SerialOutput, ReadsAsOtherBytesWithOtherSettings) {
  const LineBytes sent(400, 0x55);
  const auto read = [&](const LineSettings& host, std::int64_t step_ns) {
    simulation::SerialOutput output;
    const std::int64_t end_ns = output.send(sent, kFast, 0);
    LineBytes all;
    for (std::int64_t now_ns = 0; now_ns < end_ns + step_ns; now_ns += step_ns) {
      const LineBytes part = output.take(host, now_ns);
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  };
  EXPECT_EQ(read(kFast, 100'000), sent);
  const LineBytes parity = read({38400, Parity::kNone}, 100'000'000'000);
  EXPECT_EQ(parity.size(), 440U);
  EXPECT_EQ(parity, read({38400, Parity::kNone}, 100'000)) << "however it is taken";
  EXPECT_NE(LineBytes(parity.begin(), parity.begin() + 400), sent);
  EXPECT_EQ(read({9600, Parity::kEven}, 100'000).size(), 100U);
  EXPECT_EQ(read({500000, Parity::kEven}, 100'000).size(), 2000U);
}

}  // namespace
}  // namespace topogeo::devices
