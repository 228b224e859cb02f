#include "topogeo/devices/ldrobot_packet.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/ldrobot_optics.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

/// The example of the LD19 Development Manual.
const std::vector<std::uint8_t> kManual{
    0x54, 0x2C, 0x68, 0x08, 0xAB, 0x7E, 0xE0, 0x00, 0xE4, 0xDC, 0x00, 0xE2, 0xD9, 0x00, 0xE5, 0xD5,
    0x00, 0xE3, 0xD3, 0x00, 0xE4, 0xD0, 0x00, 0xE9, 0xCD, 0x00, 0xE4, 0xCA, 0x00, 0xE2, 0xC7, 0x00,
    0xE9, 0xC5, 0x00, 0xE5, 0xC2, 0x00, 0xE5, 0xC0, 0x00, 0xE5, 0xBE, 0x82, 0x3A, 0x1A, 0x50};

std::vector<LdPacket> packets_of(LdDecoder& decoder, const std::vector<std::uint8_t>& bytes) {
  decoder.push(bytes);
  std::vector<LdPacket> packets;
  while (const auto found = decoder.next()) packets.push_back(found->packet);
  return packets;
}

TEST(LdPacket, IsTheExampleOfTheManual) {
  LdDecoder decoder;
  const std::vector<LdPacket> packets = packets_of(decoder, kManual);
  ASSERT_EQ(packets.size(), 1U);
  const LdPacket& packet = packets[0];
  EXPECT_EQ(packet.speed_deg_s, 2152);
  EXPECT_EQ(packet.start_cdeg, 32'427);
  EXPECT_EQ(packet.end_cdeg, 33'470);
  EXPECT_EQ(packet.span_cdeg(), 1043U);
  EXPECT_EQ(packet.time_ms, 6714);
  EXPECT_EQ(packet.points[0], (LdPoint{224, 228}));
  EXPECT_EQ(packet.points[1], (LdPoint{220, 226}));
  EXPECT_EQ(packet.points[11], (LdPoint{192, 229}));
  EXPECT_EQ(decoder.counters(), LdCounters{});
  EXPECT_EQ(ld_bytes(packet), kManual);
}

TEST(LdPacket, ChecksumFollowsThePolynomialBitByBit) {
  // 0x01 shifted eight times through x^8 + x^6 + x^3 + x^2 + 1 is the polynomial itself.
  EXPECT_EQ(ld_crc(std::vector<std::uint8_t>{0x01}), 0x4D);
  EXPECT_EQ(ld_crc(std::vector<std::uint8_t>{0x02}), 0x9A);
  EXPECT_EQ(ld_crc(std::vector<std::uint8_t>{0x03}), 0x9A ^ 0x4D);
  EXPECT_EQ(ld_crc(std::vector<std::uint8_t>{0x04}), (0x9A << 1 & 0xFF) ^ 0x4D);
  EXPECT_EQ(ld_crc(std::vector<std::uint8_t>{}), 0);
}

TEST(LdPacket, EndsBeyondZero) {
  LdPacket packet;
  packet.start_cdeg = 35'900;
  packet.end_cdeg = 780;
  EXPECT_EQ(packet.span_cdeg(), 880U);
}

// At 1000 mm: 1005.9 mm ahead, 119.23 - 20.14 = 99.09 mm aside: 1010.77 mm at 5.6260 degrees. At
// 168.92 mm the receiver's line crosses the axis: no angle.
TEST(Ld08Optics, MovesPointsToTheCentre) {
  const Ld08Point far = ld08_point(1000.0);
  EXPECT_NEAR(far.range_mm, 1010.769, 0.001);
  EXPECT_NEAR(far.back_deg, 5.6260, 0.0001);
  const Ld08Point crossing = ld08_point(20.14 / 0.11923);
  EXPECT_NEAR(crossing.range_mm, 174.817, 0.001);
  EXPECT_NEAR(crossing.back_deg, 0.0, 1e-9);
  EXPECT_LT(ld08_point(100.0).back_deg, 0.0);
  for (const double distance_mm : {120.0, 500.0, 3000.0, 7900.0}) {
    EXPECT_NEAR(ld08_distance_mm(ld08_point(distance_mm).range_mm), distance_mm, 1e-6);
  }
  EXPECT_EQ(ld08_distance_mm(5.0), 0.0);
}

TEST(LdDecoder, FindsPacketsCutAnywhere) {
  for (std::size_t cut = 0; cut <= kManual.size(); ++cut) {
    LdDecoder decoder;
    const auto at = kManual.begin() + static_cast<std::ptrdiff_t>(cut);
    const std::size_t first = packets_of(decoder, {kManual.begin(), at}).size();
    const std::size_t second = packets_of(decoder, {at, kManual.end()}).size();
    EXPECT_EQ(first + second, 1U) << cut;
  }
}

TEST(LdDecoder, GivesTheBytesThatFollowed) {
  LdDecoder decoder;
  std::vector<std::uint8_t> bytes = kManual;
  bytes.insert(bytes.end(), {0x54, 0x2C, 0x00});
  decoder.push(bytes);
  const auto found = decoder.next();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->bytes_since, 3U);
  EXPECT_FALSE(decoder.next());
}

TEST(LdDecoder, NoSingleWrongBitPasses) {
  for (std::size_t bit = 0; bit < 8 * kManual.size(); ++bit) {
    std::vector<std::uint8_t> bytes = kManual;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    bytes.insert(bytes.end(), kManual.begin(), kManual.end());
    LdDecoder decoder;
    const std::vector<LdPacket> packets = packets_of(decoder, bytes);
    ASSERT_EQ(packets.size(), 1U) << "bit " << bit;
    EXPECT_EQ(ld_bytes(packets[0]), kManual);
    EXPECT_NE(decoder.counters(), LdCounters{});
  }
}

TEST(LdDecoder, RefusesWhatNoLaserSendsDespiteItsChecksum) {
  LdDecoder good;
  const LdPacket example = packets_of(good, kManual).at(0);
  const auto refused = [&](auto change) {
    LdPacket packet = example;
    change(packet);
    LdDecoder decoder;
    return packets_of(decoder, ld_bytes(packet)).empty() && decoder.counters().implausible == 1;
  };
  EXPECT_TRUE(refused([](LdPacket& p) { p.start_cdeg = 36'000; }));
  EXPECT_TRUE(refused([](LdPacket& p) { p.end_cdeg = 40'000; }));
  EXPECT_TRUE(refused([](LdPacket& p) { p.end_cdeg = p.start_cdeg; }));
  EXPECT_TRUE(refused([](LdPacket& p) { p.end_cdeg = 5000; }));
  EXPECT_TRUE(refused([](LdPacket& p) { p.speed_deg_s = 100; }));
  EXPECT_TRUE(refused([](LdPacket& p) { p.speed_deg_s = 20'000; }));
  EXPECT_TRUE(refused([](LdPacket& p) { p.time_ms = 30'001; }));
  EXPECT_FALSE(refused([](LdPacket&) {}));
}

TEST(LdDecoder, NoiseNeverBreaksIt) {
  support::Random random(7);
  LdDecoder decoder;
  std::size_t found = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint8_t> bytes(random.below(120));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    bytes.insert(bytes.end(), kManual.begin(), kManual.end());
    for (const LdPacket& packet : packets_of(decoder, bytes)) {
      if (ld_bytes(packet) == kManual) ++found;
    }
  }
  // A packet is lost only where noise looks like a header and swallows its checksum's proof.
  EXPECT_GE(found, 1990U);
}

}  // namespace
}  // namespace topogeo::devices
