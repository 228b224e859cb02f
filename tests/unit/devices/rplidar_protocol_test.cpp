#include "topogeo/devices/rplidar_protocol.hpp"

#include <cstdint>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/devices/rplidar_decoder.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

using testing::ElementsAre;

// Requests and descriptors as the Interface Protocol prints them.
TEST(RpProtocol, RequestsAreThoseOfTheDocument) {
  EXPECT_THAT(rp_request(rp_command::kStop), ElementsAre(0xA5, 0x25));
  EXPECT_THAT(rp_request(rp_command::kReset), ElementsAre(0xA5, 0x40));
  EXPECT_THAT(rp_request(rp_command::kScan), ElementsAre(0xA5, 0x20));
  EXPECT_THAT(rp_request(rp_command::kGetInfo), ElementsAre(0xA5, 0x50));
  EXPECT_THAT(rp_request(rp_command::kGetHealth), ElementsAre(0xA5, 0x52));
  EXPECT_THAT(rp_express_request(0),
              ElementsAre(0xA5, 0x82, 0x05, 0x00, 0x00, 0x00, 0x00, 0x00, 0x22));
  // 660 = 0x0294: A5 ^ F0 ^ 02 ^ 94 ^ 02 = C1.
  EXPECT_THAT(rp_motor_request(rp_command::kMotorPwm, 660),
              ElementsAre(0xA5, 0xF0, 0x02, 0x94, 0x02, 0xC1));
}

TEST(RpProtocol, DescriptorsAreThoseOfTheDocument) {
  const auto read = [](std::vector<std::uint8_t> bytes) { return rp_descriptor(bytes); };
  EXPECT_EQ(read({0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04}),
            (RpDescriptor{20, false, rp_answer::kInfo}));
  EXPECT_EQ(read({0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06}),
            (RpDescriptor{3, false, rp_answer::kHealth}));
  EXPECT_EQ(read({0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81}),
            (RpDescriptor{5, true, rp_answer::kScan}));
  EXPECT_EQ(read({0xA5, 0x5A, 0x54, 0x00, 0x00, 0x40, 0x82}),
            (RpDescriptor{84, true, rp_answer::kExpress}));
  EXPECT_FALSE(read({0xA5, 0xA5, 0x54, 0x00, 0x00, 0x40, 0x82}));
  EXPECT_THAT(rp_bytes(RpDescriptor{84, true, rp_answer::kDense}),
              ElementsAre(0xA5, 0x5A, 0x54, 0x00, 0x00, 0x40, 0x85));
}

TEST(RpProtocol, AStandardSampleWorkedByHand) {
  // Quality 47, no start: 47 << 2 | 2 = BE. 90.5 deg = 5792 / 64: 5792 << 1 | 1 = 2D41. 1234.5 mm
  // = 4938 / 4 = 134A.
  const std::vector<std::uint8_t> bytes{0xBE, 0x41, 0x2D, 0x4A, 0x13};
  const RpSample sample{false, 47, 5792, 4938};
  EXPECT_EQ(rp_sample(bytes), sample);
  EXPECT_THAT(rp_bytes(sample), ElementsAre(0xBE, 0x41, 0x2D, 0x4A, 0x13));
  EXPECT_FALSE(rp_sample(std::vector<std::uint8_t>{0xBF, 0x41, 0x2D, 0x4A, 0x13}));  // S and not S
  EXPECT_FALSE(rp_sample(std::vector<std::uint8_t>{0xBE, 0x40, 0x2D, 0x4A, 0x13}));  // no check bit
  EXPECT_FALSE(rp_sample(std::vector<std::uint8_t>{0xBE, 0x01, 0xFF, 0x4A, 0x13}));  // 510 deg
}

TEST(RpProtocol, AnExpressPacketWorkedByHand) {
  // Start 45 deg = 2880 = 0B40. First cabin: 1000 mm with compensation 0x15 (2.625 deg), 2000 mm
  // with 0x2A: words 1000 << 2 | 1 = 0FA1 and 2000 << 2 | 2 = 1F42, last byte A5. The rest is 0.
  std::vector<std::uint8_t> bytes(kRpPacket_bytes, 0);
  bytes[2] = 0x40;
  bytes[3] = 0x0B;
  bytes[4] = 0xA1;
  bytes[5] = 0x0F;
  bytes[6] = 0x42;
  bytes[7] = 0x1F;
  bytes[8] = 0xA5;
  // 40 ^ 0B ^ A1 ^ 0F ^ 42 ^ 1F ^ A5 = 1D: D in the first byte, 1 in the second.
  bytes[0] = 0xAD;
  bytes[1] = 0x51;
  const auto packet = rp_packet(bytes, rp_answer::kExpress);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->start_q6, 2880);
  EXPECT_FALSE(packet->starts);
  ASSERT_EQ(packet->points.size(), kRpExpressPoints);
  EXPECT_EQ(packet->points[0], (RpPacket::Point{1000.0, 0x15}));
  EXPECT_EQ(packet->points[1], (RpPacket::Point{2000.0, 0x2A}));
  EXPECT_EQ(packet->points[2], (RpPacket::Point{0.0, 0}));
  EXPECT_EQ(rp_bytes(*packet, rp_answer::kExpress), bytes);

  // The next packet starts at 77 deg: a degree a point.
  const std::uint16_t next_q6 = 77 * 64;
  EXPECT_DOUBLE_EQ(rp_angle_deg(*packet, next_q6, 0, false), 45.0 - 2.625);
  EXPECT_DOUBLE_EQ(rp_angle_deg(*packet, next_q6, 1, false), 46.0 - 5.25);
  EXPECT_DOUBLE_EQ(rp_angle_deg(*packet, next_q6, 1, true), 46.0 + 2.75);  // 0x2A - 64 = -22
  EXPECT_DOUBLE_EQ(rp_angle_deg(*packet, next_q6, 31, false), 76.0);
}

TEST(RpProtocol, APacketBeforeZeroEndsBehindIt) {
  RpPacket packet;
  packet.start_q6 = 350 * 64;
  packet.points.resize(kRpExpressPoints);
  EXPECT_DOUBLE_EQ(rp_angle_deg(packet, 22 * 64, 16, false), 366.0);
}

TEST(RpProtocol, ADensePacketHasFortyDistances) {
  RpPacket packet;
  packet.start_q6 = 64;
  packet.starts = true;
  for (std::size_t i = 0; i < kRpDensePoints; ++i) {
    packet.points.push_back({static_cast<double>(1000 * i), 0});
  }
  const std::vector<std::uint8_t> bytes = rp_bytes(packet, rp_answer::kDense);
  ASSERT_EQ(bytes.size(), kRpPacket_bytes);
  EXPECT_EQ(rp_packet(bytes, rp_answer::kDense), packet);
  EXPECT_EQ(bytes[3], 0x80);
  EXPECT_EQ(bytes[6] | bytes[7] << 8, 1000);
}

TEST(RpProtocol, NoSingleWrongBitOfAPacketPasses) {
  RpPacket packet;
  packet.start_q6 = 1234;
  packet.points.resize(kRpExpressPoints, {3210.0, 5});
  const std::vector<std::uint8_t> good = rp_bytes(packet, rp_answer::kExpress);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::uint8_t> bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(rp_packet(bytes, rp_answer::kExpress)) << "bit " << bit;
  }
}

TEST(RpDecoder, FindsAnswersInNoiseCutAnywhere) {
  std::vector<std::uint8_t> bytes{0x00, 0xA5, 0x13};
  const auto put = [&bytes](const std::vector<std::uint8_t>& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  put(rp_bytes(RpDescriptor{3, false, rp_answer::kHealth}));
  put({1, 0x34, 0x12});
  put(rp_bytes(RpDescriptor{kRpPacket_bytes, true, rp_answer::kExpress}));
  RpPacket packet;
  packet.points.resize(kRpExpressPoints);
  put(rp_bytes(packet, rp_answer::kExpress));
  put({0xFF});
  packet.start_q6 = 640;
  put(rp_bytes(packet, rp_answer::kExpress));
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    RpDecoder decoder;
    std::vector<RpDecoder::Answer> answers;
    const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(cut);
    for (const std::vector<std::uint8_t>& part : {std::vector<std::uint8_t>(bytes.begin(), at),
                                                  std::vector<std::uint8_t>(at, bytes.end())}) {
      decoder.push(part);
      while (auto answer = decoder.next()) answers.push_back(*std::move(answer));
    }
    ASSERT_EQ(answers.size(), 4U) << cut;
    EXPECT_THAT(answers[0].data, ElementsAre(1, 0x34, 0x12));
    EXPECT_TRUE(answers[1].data.empty());
    EXPECT_TRUE(answers[2].contiguous);
    EXPECT_FALSE(answers[3].contiguous);
    EXPECT_EQ(decoder.counters(), (RpCounters{4, 0}));
  }
}

TEST(RpDecoder, NoiseNeverBreaksIt) {
  support::Random random(9);
  for (const std::uint8_t type : {rp_answer::kScan, rp_answer::kExpress, rp_answer::kDense}) {
    RpDecoder decoder;
    const std::uint32_t length = type == rp_answer::kScan ? kRpSample_bytes : kRpPacket_bytes;
    decoder.push(rp_bytes(RpDescriptor{length, true, type}));
    for (int round = 0; round < 500; ++round) {
      std::vector<std::uint8_t> bytes(random.below(200));
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
      decoder.push(bytes);
      while (const auto answer = decoder.next()) {
        EXPECT_TRUE(answer->data.empty() || answer->data.size() == length);
      }
    }
  }
}

}  // namespace
}  // namespace topogeo::devices
