#include "topogeo/devices/base_writer.hpp"

#include <gtest/gtest.h>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

std::string text_of(const LineOrder& order) {
  return {order.bytes.begin(), order.bytes.end()};
}

TEST(BaseWriter, WaitsForTheLineAndAtLeastForTheGap) {
  BaseSettings settings;  // 9600 baud, 10 ms between commands
  BaseWriter writer(settings);
  writer.open(100);
  EXPECT_EQ(writer.free_ns(), 100);
  writer.write({McpCommand::kTranslateHalt}, 100);  // three bytes take 3.1 ms
  EXPECT_EQ(writer.free_ns(), 100 + 10'000'000);
  settings.write_gap_s = 0.0;
  BaseWriter fast(settings);
  fast.open(0);
  fast.write({McpCommand::kTranslateHalt}, 0);
  EXPECT_EQ(fast.free_ns(), line_time_ns(3, settings.line));
  fast.write({McpCommand::kRotateHalt}, 0);  // written before the line is free, sent after it
  EXPECT_EQ(fast.free_ns(), 2 * line_time_ns(3, settings.line));
  const auto orders = fast.take_orders();
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(text_of(orders[0]), "TH\r");
  EXPECT_EQ(text_of(orders[1]), "RH\r");
  EXPECT_TRUE(fast.take_orders().empty());
}

TEST(BaseWriter, OpensWithTheSettingsOfTheLine) {
  BaseSettings settings;
  settings.line.baud = 38400;
  BaseWriter writer(settings);
  writer.open(0);
  writer.queue({McpCommand::kTranslateHalt});  // replaced
  writer.queue_opening();
  writer.queue({McpCommand::kHalfDuplex});
  EXPECT_TRUE(writer.write_queued(0));
  EXPECT_TRUE(writer.write_queued(0));
  EXPECT_FALSE(writer.write_queued(0));
  const auto orders = writer.take_orders();
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(orders[0].settings, settings.line);
  EXPECT_EQ(text_of(orders[0]), "\r");
  EXPECT_EQ(text_of(orders[1]), "HD\r");
}

TEST(BaseWriter, EntersTheBinaryDialectAndRestsThere) {
  BaseSettings settings;
  settings.dialect = BaseDialect::kBinary;
  BaseWriter writer(settings);
  writer.open(0);
  writer.queue_opening();
  EXPECT_TRUE(writer.write_queued(0));
  EXPECT_EQ(writer.free_ns(), 250'000'000);
  writer.queue({McpCommand::kTranslateHalt});
  writer.queue_sync();  // it is sent first
  while (writer.write_queued(writer.free_ns())) {
  }
  const auto orders = writer.take_orders();
  ASSERT_EQ(orders.size(), 4U);
  EXPECT_EQ(text_of(orders[0]), "\rBE FFFF\rDM\r");
  EXPECT_EQ(orders[1].bytes, std::vector<std::uint8_t>(kMcpSyncZeros));
  EXPECT_EQ(orders[2].bytes, std::vector<std::uint8_t>(kMcpSyncZeros));
  EXPECT_EQ(orders[3].bytes.size(), 6U);
}

TEST(BaseWriter, DropsWhatWaitsWhenThePortIsGone) {
  BaseWriter writer{BaseSettings{}};
  writer.open(0);
  writer.write({McpCommand::kTranslateHalt}, 0);
  writer.queue({McpCommand::kRotateHalt});
  writer.close();
  EXPECT_TRUE(writer.queue_empty());
  EXPECT_TRUE(writer.take_orders().empty());
}

}  // namespace
}  // namespace topogeo::devices
