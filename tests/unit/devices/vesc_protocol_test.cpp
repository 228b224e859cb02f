// Protocol of VESC controllers: packets worked by hand.
#include "topogeo/devices/vesc_protocol.hpp"

#include <cstdint>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<VescPacket> read(VescReader& reader, const Bytes& bytes) {
  std::vector<VescPacket> packets;
  reader.push(bytes);
  while (auto packet = reader.next()) packets.push_back(*packet);
  return packets;
}

TEST(VescProtocol, PacketsHaveALengthACrcAndAnEnd) {
  // The check value of CRC-16/XMODEM.
  const Bytes digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(to_bytes(VescPacket{digits}),
            (Bytes{2, 9, '1', '2', '3', '4', '5', '6', '7', '8', '9', 0x31, 0xC3, 3}));
  VescReader reader;
  EXPECT_THAT(read(reader, to_bytes(VescPacket{digits})), ElementsAre(VescPacket{digits}));
  EXPECT_EQ(reader.counters(), VescCounters());
}

TEST(VescProtocol, CommandsHaveTheHigherByteFirst) {
  EXPECT_EQ(vesc_set_rpm(-2).payload, (Bytes{8, 0xFF, 0xFF, 0xFF, 0xFE}));
  EXPECT_EQ(vesc_set_rpm(4660).payload, (Bytes{8, 0, 0, 0x12, 0x34}));
  EXPECT_EQ(vesc_get_values().payload, (Bytes{50, 0x00, 0x02, 0xA1, 0x00}));
  EXPECT_EQ(vesc_forward(7, vesc_set_rpm(1)).payload, (Bytes{34, 7, 8, 0, 0, 0, 1}));
  EXPECT_EQ(vesc_rpm(vesc_set_rpm(-4660)), -4660);
  EXPECT_FALSE(vesc_rpm(vesc_get_values()));
}

TEST(VescProtocol, ValuesAreThoseOfTheMask) {
  const VescPacket answer{{50, 0x00, 0x02, 0xA1, 0x00, 0x00, 0xF6, 0xFF, 0xFF, 0xFF, 0x9C, 2, 9}};
  const VescValues values{.battery_dv = 246, .tachometer = -100, .fault = 2, .controller = 9};
  EXPECT_EQ(vesc_values(answer), values);
  EXPECT_EQ(to_packet(values), answer);
  VescPacket other = answer;
  other.payload[2] = 0;
  EXPECT_FALSE(vesc_values(other)) << "other values than those that were asked";
  other = answer;
  other.payload.pop_back();
  EXPECT_FALSE(vesc_values(other));
}

TEST(VescProtocol, DamagedPacketsAreDroppedAndTheNextOneIsFound) {
  const Bytes good = to_bytes(vesc_get_values());
  for (std::size_t at = 0; at < good.size(); ++at) {
    Bytes bytes = good;
    bytes[at] ^= 0x40U;
    bytes.insert(bytes.end(), 300, 0);  // a longer length ends, too
    bytes.insert(bytes.end(), good.begin(), good.end());
    VescReader reader;
    EXPECT_THAT(read(reader, bytes), ElementsAre(vesc_get_values())) << at;
    EXPECT_NE(reader.counters(), VescCounters()) << at;
  }
  VescReader reader;
  EXPECT_THAT(read(reader, {0, 7, 2, 0, 3}), IsEmpty());
  EXPECT_EQ(reader.counters().noise_bytes, 5U);
}

}  // namespace
}  // namespace topogeo::devices
