#include "topogeo/devices/pls_line.hpp"

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

TEST(PlsLine, OpensWhereTheSensorWasHeardOrAsAfterPowerOn) {
  const PlsSettings settings;
  PlsLine line(settings);
  line.open();
  EXPECT_EQ(line.settings(), (LineSettings{9600, Parity::kEven}));
  line.set({38400, Parity::kNone});
  line.heard();
  line.set({19200, Parity::kEven});
  line.close();
  line.open();
  EXPECT_EQ(line.settings(), (LineSettings{38400, Parity::kNone}));
  EXPECT_TRUE(line.lms());
  EXPECT_EQ(line.power_on(), (LineSettings{9600, Parity::kNone})) << "of the kind that was heard";
  const auto orders = line.take_orders();
  ASSERT_EQ(orders.size(), 1U) << "what was ordered before is gone with the port";
  EXPECT_EQ(orders[0].settings, line.settings());
}

TEST(PlsLine, OrdersAChangeOfSettingsOnceAndCountsGarbageFromThen) {
  const PlsSettings settings;
  PlsLine line(settings);
  line.open();
  const std::vector<std::uint8_t> garbage(10, 0x55);
  line.receive(garbage, 5);
  EXPECT_EQ(line.last_byte_ns(), 5);
  EXPECT_FALSE(line.decoder().next());
  EXPECT_EQ(line.garbage(), 10U);
  (void)line.take_orders();
  line.set(line.settings());
  EXPECT_TRUE(line.take_orders().empty());
  EXPECT_EQ(line.garbage(), 0U);
}

TEST(PlsLine, AScanTakesItsTimeOnTheLine) {
  const PlsSettings settings;
  PlsLine line(settings);
  line.open();
  EXPECT_EQ(line.scan_time_ns(), 838'750'000) << "732 bytes of 11 bits at 9600 baud";
}

}  // namespace
}  // namespace topogeo::devices
