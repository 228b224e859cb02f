#include "topogeo/devices/ydlidar_packet.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The example of the SDK's Communication Protocol: a packet that starts a turn.
const Bytes kZeroPacket{0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE, 0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00};

/// The angles of its example of the angle analysis, 0x6FE5 and 0x79BD, with two samples: 0x0FA0 =
/// 4000 quarters of a millimetre and 0x6FE5. The checksum is 0x55AA ^ 0x6FE5 ^ 0x0FA0 ^ 0x6FE5 ^
/// 0x0200 ^ 0x79BD = 0x21B7.
const Bytes kTwoSamples{0xAA, 0x55, 0x00, 0x02, 0xE5, 0x6F, 0xBD,
                        0x79, 0xB7, 0x21, 0xA0, 0x0F, 0xE5, 0x6F};

/// Finds the packets before the header of one more.
std::vector<YdPacket> packets_in(YdDecoder& decoder, Bytes bytes) {
  bytes.insert(bytes.end(), {0xAA, 0x55});
  decoder.push(bytes);
  std::vector<YdPacket> packets;
  while (const auto found = decoder.next()) {
    if (found->packet) packets.push_back(*found->packet);
  }
  return packets;
}

TEST(YdPacket, ThatStartsATurnIsTheExampleOfTheDocument) {
  YdDecoder decoder;
  const std::vector<YdPacket> packets = packets_in(decoder, kZeroPacket);
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_TRUE(packets[0].starts_turn);
  EXPECT_EQ(packets[0].turns_dhz, 0);
  EXPECT_EQ(packets[0].first_q6, 0xAE53 >> 1);  // 348.64 degrees
  EXPECT_EQ(packets[0].samples, std::vector<std::uint16_t>{0});
  EXPECT_EQ(yd_bytes(packets[0]), kZeroPacket);
  EXPECT_EQ(decoder.counters(), YdCounters{});
}

TEST(YdPacket, HasTheAnglesOfTheDocument) {
  YdDecoder decoder;
  const std::vector<YdPacket> packets = packets_in(decoder, kTwoSamples);
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_FALSE(packets[0].starts_turn);
  EXPECT_NEAR(packets[0].first_q6 / 64.0, 223.78, 0.01);
  EXPECT_NEAR(packets[0].last_q6 / 64.0, 243.47, 0.01);
  EXPECT_NEAR(packets[0].span_q6() / 64.0, 19.69, 0.01);
  EXPECT_EQ(packets[0].samples, (std::vector<std::uint16_t>{4000, 0x6FE5}));
  EXPECT_NEAR(0.25 * packets[0].samples[1], 7161.25, 1e-9);
  EXPECT_EQ(yd_bytes(packets[0]), kTwoSamples);
}

TEST(YdPacket, CorrectsAnglesAsTheDocumentWorksOut) {
  EXPECT_NEAR(yd_correction_deg(1000.0), -6.7622, 1e-4);
  EXPECT_NEAR(yd_correction_deg(8000.0), -7.8374, 1e-4);
  EXPECT_EQ(yd_correction_deg(0.0), 0.0);
  EXPECT_NEAR(yd_correction_deg(155.3), 0.0, 1e-12);
  EXPECT_NEAR(yd_correction_deg(1e9), yd_far_correction_deg(), 1e-4);
}

TEST(YdPacket, ReportsTheFrequency) {
  YdPacket packet{
      .starts_turn = true, .turns_dhz = 71, .first_q6 = 12, .last_q6 = 12, .samples = {8}};
  EXPECT_EQ(yd_bytes(packet)[2], 71 << 1 | 1);
  YdDecoder decoder;
  EXPECT_EQ(packets_in(decoder, yd_bytes(packet)), std::vector<YdPacket>{packet});
}

TEST(YdDecoder, FindsAnswersBetweenPackets) {
  // The start of a scan (X2 Development Manual), then health: good.
  Bytes bytes{0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
  bytes.insert(bytes.end(), kZeroPacket.begin(), kZeroPacket.end());
  const Bytes health{0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06, 0x02, 0x34, 0x12};
  bytes.insert(bytes.end(), health.begin(), health.end());
  YdDecoder decoder;
  decoder.push(bytes);
  auto found = decoder.next();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->answer_type, yd_answer::kScan);
  EXPECT_EQ(found->bytes_since, kZeroPacket.size() + health.size());
  found = decoder.next();
  ASSERT_TRUE(found && found->packet);
  found = decoder.next();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->answer_type, yd_answer::kHealth);
  EXPECT_EQ(found->answer, (Bytes{0x02, 0x34, 0x12}));
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.counters(), YdCounters{});
}

TEST(YdDecoder, FindsPacketsCutAnywhere) {
  for (std::size_t cut = 0; cut <= kTwoSamples.size(); ++cut) {
    YdDecoder decoder;
    const auto at = kTwoSamples.begin() + static_cast<std::ptrdiff_t>(cut);
    decoder.push(Bytes(kTwoSamples.begin(), at));
    const std::size_t first = decoder.next() ? 1 : 0;
    const std::size_t second = packets_in(decoder, {at, kTwoSamples.end()}).size();
    EXPECT_EQ(first + second, 1U) << cut;
  }
}

TEST(YdDecoder, NoSingleWrongBitPasses) {
  for (std::size_t bit = 0; bit < 8 * kTwoSamples.size(); ++bit) {
    Bytes bytes = kTwoSamples;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    // The bytes that a packet with a wrong count may take.
    for (int copy = 0; copy < 40; ++copy) {
      bytes.insert(bytes.end(), kTwoSamples.begin(), kTwoSamples.end());
    }
    YdDecoder decoder;
    const std::vector<YdPacket> packets = packets_in(decoder, bytes);
    EXPECT_EQ(packets.size(), 40U) << "bit " << bit;
    for (const YdPacket& packet : packets) EXPECT_EQ(yd_bytes(packet), kTwoSamples);
    EXPECT_NE(decoder.counters(), YdCounters{});
  }
}

TEST(YdDecoder, APacketThatNoHeaderFollowsIsDropped) {
  Bytes bytes = kTwoSamples;
  bytes.insert(bytes.end(), {0x12, 0x34});
  YdDecoder decoder;
  decoder.push(bytes);
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.counters().alone, 1U);
}

TEST(YdDecoder, RefusesWhatNoLaserSendsDespiteItsChecksum) {
  const auto refused = [](const YdPacket& packet) {
    YdDecoder decoder;
    return packets_in(decoder, yd_bytes(packet)).empty() && decoder.counters().implausible == 1;
  };
  const YdPacket good{.first_q6 = 100, .last_q6 = 900, .samples = {1, 2}};
  EXPECT_FALSE(refused(good));
  YdPacket wide = good;
  wide.last_q6 = 10'000;
  EXPECT_TRUE(refused(wide));
  YdPacket beyond = good;
  beyond.first_q6 = kYdTurnQ6;
  EXPECT_TRUE(refused(beyond));
  YdPacket narrow = good;
  narrow.last_q6 = good.first_q6;
  EXPECT_TRUE(refused(narrow));
  YdPacket start = good;
  start.starts_turn = true;
  EXPECT_TRUE(refused(start));
}

TEST(YdDecoder, NoiseNeverBreaksIt) {
  support::Random random(7);
  YdDecoder decoder;
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes(random.below(120));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    bytes.insert(bytes.end(), kTwoSamples.begin(), kTwoSamples.end());
    for (const YdPacket& packet : packets_in(decoder, bytes)) {
      EXPECT_EQ(yd_bytes(packet), kTwoSamples);
    }
  }
}

}  // namespace
}  // namespace topogeo::devices
