#include "topogeo/devices/pls_supervisor.hpp"

#include <gtest/gtest.h>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

struct Supervised {
  explicit Supervised(PlsOutput output) {
    settings.output = output;
    line.open();
    line.set({500'000, Parity::kEven});
    (void)line.take_orders();
    supervisor.start(0);
  }
  PlsSettings settings;
  PlsLine line{settings};
  SickExchange exchange;
  PlsSupervisor supervisor{settings, line, exchange};
};

TEST(PlsSupervisor, NoticesThatScansStayAway) {
  Supervised laser(PlsOutput::kContinuous);
  EXPECT_EQ(laser.supervisor.due_ns(), 1'000'000'000);
  laser.supervisor.scan_came(400'000'000);
  EXPECT_FALSE(laser.supervisor.silent(1'399'999'999));
  EXPECT_TRUE(laser.supervisor.silent(1'400'000'000));
  EXPECT_EQ(laser.supervisor.silence_ns(1'400'000'000), 1'000'000'000);
  laser.supervisor.tick(1'400'000'000);
  EXPECT_TRUE(laser.line.take_orders().empty()) << "a continuous stream is not asked for";
}

TEST(PlsSupervisor, WaitsThreeTimesAsLongForASensorThatIsHeard) {
  Supervised laser(PlsOutput::kContinuous);
  const std::vector<std::uint8_t> byte{0x55};
  for (std::int64_t now_ns = 0; now_ns < 2'900'000'000; now_ns += 100'000'000) {
    laser.line.receive(byte, now_ns);
    EXPECT_FALSE(laser.supervisor.silent(now_ns + 50'000'000));
  }
  laser.line.receive(byte, 2'990'000'000);
  EXPECT_TRUE(laser.supervisor.silent(3'000'000'000));
}

TEST(PlsSupervisor, AsksForAScanEachPeriodAndRestsAfterARequestInVain) {
  Supervised laser(PlsOutput::kOnRequest);
  laser.supervisor.tick(0);
  const auto orders = laser.line.take_orders();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].bytes, pls_scan_request());
  laser.supervisor.tick(1'000'000);
  EXPECT_TRUE(laser.line.take_orders().empty()) << "the request is open";
  laser.exchange.replied(std::nullopt);
  laser.supervisor.request_ended(20'000'000);
  EXPECT_EQ(laser.supervisor.due_ns(), 40'000'000);
  laser.supervisor.tick(40'000'000);
  EXPECT_EQ(laser.line.take_orders().size(), 1U);
  laser.exchange.stop();
  laser.supervisor.request_ended(70'000'000);
  EXPECT_EQ(laser.supervisor.due_ns(), 100'000'000);
}

}  // namespace
}  // namespace topogeo::devices
