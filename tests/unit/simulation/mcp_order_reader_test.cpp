#include "topogeo/simulation/mcp_order_reader.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/mcp_binary.hpp"

namespace topogeo::simulation {
namespace {

using devices::McpCommand;
using devices::McpOrder;

struct Orders {
  std::vector<McpOrder> orders;
  int damaged = 0;
};

template <typename Bytes>
Orders read_all(McpOrderReader& reader, const Bytes& bytes) {
  Orders all;
  for (const auto byte : bytes) {
    const McpOrderReader::Reading reading = reader.read(static_cast<std::uint8_t>(byte));
    if (reading.order) all.orders.push_back(*reading.order);
    all.damaged += reading.damaged ? 1 : 0;
  }
  return all;
}

const std::vector<std::uint8_t> kSync(7, 0);

TEST(McpOrderReader, ReadsALineAtItsEnd) {
  McpOrderReader reader;
  EXPECT_TRUE(read_all(reader, std::string_view("TV 1f")).orders.empty());
  EXPECT_EQ(read_all(reader, std::string_view("4\r")).orders,
            (std::vector<McpOrder>{{McpCommand::kTranslateVelocity, 0x1f4}}));
}

TEST(McpOrderReader, PassesOverLinesThatAreNoOrders) {
  McpOrderReader reader;
  EXPECT_TRUE(
      read_all(reader, std::string_view("nonsense\rTV\rTV fffff\rBV 1\r\r")).orders.empty());
  EXPECT_TRUE(read_all(reader, std::string(1000, 'B')).orders.empty());
  EXPECT_TRUE(read_all(reader, std::string_view("V\r")).orders.empty()) << "of the long line";
  EXPECT_EQ(read_all(reader, std::string_view("BV\r")).orders.size(), 1U);
}

TEST(McpOrderReader, ReadsPacketsAfterZeros) {
  McpOrderReader reader;
  reader.switch_dialect();
  EXPECT_TRUE(reader.binary());
  const McpOrder order{McpCommand::kTranslateVelocity, 0x1f4};
  const devices::McpPacket packet = devices::binary_packet(order);
  EXPECT_TRUE(read_all(reader, packet).orders.empty()) << "it does not know where packets begin";
  read_all(reader, kSync);
  EXPECT_EQ(read_all(reader, packet).orders, std::vector<McpOrder>{order});
  EXPECT_EQ(read_all(reader, packet).orders, std::vector<McpOrder>{order});
}

TEST(McpOrderReader, ADamagedPacketIsReportedAndTheStartSearchedAgain) {
  McpOrderReader reader;
  reader.switch_dialect();
  read_all(reader, kSync);
  const McpOrder order{McpCommand::kTranslateVelocity, 0x1f4};
  devices::McpPacket packet = devices::binary_packet(order);
  packet[3] ^= 4;
  EXPECT_EQ(read_all(reader, packet).damaged, 1);
  packet[3] ^= 4;
  EXPECT_TRUE(read_all(reader, packet).orders.empty());
  read_all(reader, kSync);
  EXPECT_EQ(read_all(reader, packet).orders.size(), 1U);
}

}  // namespace
}  // namespace topogeo::simulation
