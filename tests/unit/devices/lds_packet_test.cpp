#include "topogeo/devices/lds_packet.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Packet 0 at 300 turns a minute (19200 / 64): 1000 mm, no return (mark 0x80), 500 mm with the
/// mark of weak returns (0x40), 6000 mm. The checksum doubles a sum and adds each word: 0xA0FA =
/// 41210, then 101620, 204240, 408580, 849930, 1699860, 3416604, 6833218, 13672436, 27345127, whose
/// lower 15 bits are 16615 and whose upper bits 834: together 17449 = 0x4429.
const Bytes kXv11Packet{0xFA, 0xA0, 0x00, 0x4B, 0xE8, 0x03, 0x64, 0x00, 0x02, 0x80, 0x00,
                        0x00, 0xF4, 0x41, 0x0A, 0x00, 0x70, 0x17, 0xFF, 0x00, 0x29, 0x44};

/// Packet 1 at 300 turns a minute (3000 / 10): intensity 500, then 1000 to 1005 mm.
Bytes lds01_packet() {
  Bytes bytes{0xFA, 0xA1, 0xB8, 0x0B};
  for (std::uint8_t i = 0; i < 6; ++i) {
    const Bytes reading{0xF4, 0x01, static_cast<std::uint8_t>(0xE8 + i), 0x03, 0x00, 0x00};
    bytes.insert(bytes.end(), reading.begin(), reading.end());
  }
  const std::uint16_t checksum = lds_checksum(bytes);
  bytes.push_back(static_cast<std::uint8_t>(checksum & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(checksum >> 8));
  return bytes;
}

/// A packet counts once the header of the next one has arrived.
Bytes with_next(Bytes packet) {
  packet.insert(packet.end(), {0xFA, static_cast<std::uint8_t>(packet[1] + 1)});
  return packet;
}

std::vector<LdsPacket> found_by(LdsDecoder& decoder, const Bytes& bytes) {
  decoder.push(bytes);
  std::vector<LdsPacket> packets;
  while (const auto found = decoder.next()) packets.push_back(found->packet);
  return packets;
}

/// A whole turn of packets, several times.
Bytes turns_of(const LdsFormat& format, int turns, std::uint8_t change_checksum = 0) {
  Bytes stream;
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t number = 0; number < format.packets; ++number) {
      LdsPacket packet;
      packet.number = number;
      packet.speed = static_cast<std::uint16_t>(300.0 / format.rpm_per_unit);
      packet.readings.assign(format.readings, {1234, 200});
      Bytes bytes = lds_bytes(packet, format);
      bytes.back() ^= change_checksum;
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
  }
  return stream;
}

TEST(LdsPacket, OfAnXv11IsWorkedByHand) {
  EXPECT_EQ(lds_checksum(std::span(kXv11Packet).first(20)), 0x4429);
  LdsDecoder decoder(kXv11, LdsChecksum::kDrop);
  const std::vector<LdsPacket> packets = found_by(decoder, with_next(kXv11Packet));
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(packets[0].number, 0U);
  EXPECT_EQ(packets[0].speed, 19'200);
  const std::vector<LdsReading> readings{{1000, 100}, {0, 0}, {500, 10}, {6000, 255}};
  EXPECT_EQ(packets[0].readings, readings);
  EXPECT_EQ(decoder.counters(), LdsCounters{});
}

TEST(LdsPacket, OfAnLds01HasIntensityBeforeDistance) {
  LdsDecoder decoder(kLds01, LdsChecksum::kDrop);
  const Bytes bytes = lds01_packet();
  ASSERT_EQ(bytes.size(), 42U);
  const std::vector<LdsPacket> packets = found_by(decoder, with_next(bytes));
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(packets[0].number, 1U);
  EXPECT_EQ(packets[0].speed, 3000);
  EXPECT_EQ(packets[0].readings[0], (LdsReading{1000, 500}));
  EXPECT_EQ(packets[0].readings[5], (LdsReading{1005, 500}));
  EXPECT_EQ(lds_bytes(packets[0], kLds01), bytes);
}

TEST(LdsDecoder, FindsPacketsCutAnywhere) {
  const Bytes stream = with_next(kXv11Packet);
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    LdsDecoder decoder(kXv11, LdsChecksum::kDrop);
    const auto at = stream.begin() + static_cast<std::ptrdiff_t>(cut);
    const std::size_t first = found_by(decoder, {stream.begin(), at}).size();
    const std::size_t second = found_by(decoder, {at, stream.end()}).size();
    EXPECT_EQ(first + second, 1U) << cut;
  }
}

TEST(LdsDecoder, NoSingleWrongBitPasses) {
  for (std::size_t bit = 0; bit < 8 * kXv11Packet.size(); ++bit) {
    Bytes bytes = kXv11Packet;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    const Bytes good = with_next(kXv11Packet);
    bytes.insert(bytes.end(), good.begin(), good.end());
    LdsDecoder decoder(kXv11, LdsChecksum::kDrop);
    const std::vector<LdsPacket> packets = found_by(decoder, bytes);
    ASSERT_EQ(packets.size(), 1U) << "bit " << bit;
    EXPECT_EQ(packets[0].readings[0].distance_mm, 1000);
    EXPECT_NE(decoder.counters(), LdsCounters{});
  }
}

TEST(LdsDecoder, APacketThatTheNextDoesNotFollowIsDropped) {
  LdsDecoder decoder(kXv11, LdsChecksum::kDrop);
  Bytes bytes = kXv11Packet;
  bytes.insert(bytes.end(), {0xFA, 0xA5});
  EXPECT_TRUE(found_by(decoder, bytes).empty());
  EXPECT_EQ(decoder.counters().alone, 1U);
}

TEST(LdsDecoder, ASpeedThatNoLaserHasIsRefused) {
  for (const std::uint16_t speed : {std::uint16_t{500}, std::uint16_t{65'000}}) {
    LdsPacket packet{3, speed, std::vector<LdsReading>(4)};
    LdsDecoder decoder(kXv11, LdsChecksum::kDrop);
    EXPECT_TRUE(found_by(decoder, with_next(lds_bytes(packet, kXv11))).empty());
    EXPECT_EQ(decoder.counters().implausible, 1U);
  }
}

TEST(LdsDecoder, LearnsThatChecksumsAreRight) {
  LdsDecoder decoder(kLds01, LdsChecksum::kLearn);
  EXPECT_EQ(found_by(decoder, turns_of(kLds01, 1)).size(), 59U - 7U);
  EXPECT_EQ(decoder.checksum(), LdsChecksum::kDrop);
  EXPECT_EQ(found_by(decoder, turns_of(kLds01, 1, 0x10)).size(), 1U);
  EXPECT_EQ(decoder.counters().bad_checksum, 59U);
  decoder.clear();
  EXPECT_EQ(decoder.checksum(), LdsChecksum::kLearn);
}

TEST(LdsDecoder, LearnsThatChecksumsFollowAnotherRule) {
  LdsDecoder decoder(kLds01, LdsChecksum::kLearn);
  EXPECT_EQ(found_by(decoder, turns_of(kLds01, 2, 0x10)).size(), 119U - 63U);
  EXPECT_EQ(decoder.checksum(), LdsChecksum::kWarn);
}

TEST(LdsDecoder, NoiseNeverBreaksIt) {
  support::Random random(7);
  LdsDecoder decoder(kXv11, LdsChecksum::kDrop);
  std::size_t found = 0;
  const Bytes stream = with_next(kXv11Packet);
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes(random.below(120));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    bytes.insert(bytes.end(), stream.begin(), stream.end());
    for (const LdsPacket& packet : found_by(decoder, bytes)) {
      EXPECT_EQ(packet.readings[3].distance_mm, 6000);
      ++found;
    }
  }
  // The last packet waits for its successor only.
  EXPECT_GE(found, 1990U);
}

}  // namespace
}  // namespace topogeo::devices
