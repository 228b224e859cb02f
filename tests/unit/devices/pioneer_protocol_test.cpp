// Protocol of the Pioneers: packets worked by hand from the maker's manuals.
#include "topogeo/devices/pioneer_protocol.hpp"

#include <vector>

#include <gmock/gmock.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;

using Bytes = std::vector<std::uint8_t>;

// 26 bytes of payload. Moving; x 32,766 mm, y 258 mm, heading -1,024 units (a quarter turn to the
// right); wheels 300 and -2 mm/s; 12.6 V; left wheel stalled, third bumper of the second group;
// setpoint 0; motors on, sonar array 1 on, stop button; no compass; two sonars: number 3 with 1,000
// mm, number 7 with 5,000 mm. The words 33FE 7F02 0100 FC2C 01FE FF7E 0108 0000 2300 0002 03E8
// 0307 8813 sum up to 364B4.
const Bytes kReportByHand{0xFA, 0xFB, 28,   0x33, 0xFE, 0x7F, 0x02, 0x01, 0x00, 0xFC, 0x2C,
                          0x01, 0xFE, 0xFF, 0x7E, 0x01, 0x08, 0x00, 0x00, 0x23, 0x00, 0x00,
                          2,    3,    0xE8, 0x03, 7,    0x88, 0x13, 0x64, 0xB4};

TEST(PioneerProtocol, SynchronizationIsThatOfTheManual) {
  EXPECT_THAT(to_bytes(PioneerOrder{0}), ElementsAre(250, 251, 3, 0, 0, 0));
  EXPECT_THAT(to_bytes(PioneerOrder{1}), ElementsAre(250, 251, 3, 1, 0, 1));
  EXPECT_THAT(to_bytes(PioneerOrder{2}), ElementsAre(250, 251, 3, 2, 0, 2));
}

TEST(PioneerProtocol, EnableIsThatOfTheManual) {
  EXPECT_THAT(to_bytes(PioneerOrder{pioneer_command::kEnable, 1}),
              ElementsAre(0xFA, 0xFB, 0x06, 0x04, 0x3B, 0x01, 0x00, 0x05, 0x3B));
}

// -200 mm/s: the type is that of a negative number, the number 0x00C8. 0B1B + C800 = D31B.
TEST(PioneerProtocol, ANegativeNumberHasATypeOfItsOwn) {
  const Bytes bytes{0xFA, 0xFB, 6, 11, 0x1B, 0xC8, 0x00, 0xD3, 0x1B};
  EXPECT_EQ(to_bytes(PioneerOrder{pioneer_command::kSpeed, -200}), bytes);
  PioneerReader reader;
  reader.push(bytes);
  EXPECT_EQ(pioneer_order(reader.next().value()), (PioneerOrder{pioneer_command::kSpeed, -200}));
  EXPECT_FALSE(pioneer_order({{11, 0x2B, 1, 65}})) << "a text";
  EXPECT_FALSE(pioneer_order({{11, 0x3B, 1}}));
}

// 0102 + 0304 = 0406; an odd byte changes the lower one only.
TEST(PioneerProtocol, TheChecksumIsASumOfWords) {
  EXPECT_EQ(pioneer_checksum(Bytes{1, 2, 3, 4}), 0x0406);
  EXPECT_EQ(pioneer_checksum(Bytes{1, 2, 3, 4, 5}), 0x0406 ^ 5);
  EXPECT_EQ(pioneer_checksum(Bytes{0xFF, 0xFF, 0x00, 0x02}), 0x0001) << "carries are lost";
}

std::optional<PioneerReport> read(const Bytes& payload) {
  return pioneer_report({payload});
}

Bytes payload_by_hand() {
  return {kReportByHand.begin() + 3, kReportByHand.end() - 2};
}

TEST(PioneerProtocol, AReportIsReadAsWorkedByHand) {
  const auto report = read(payload_by_hand());
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->moves);
  EXPECT_EQ(report->x, 32'766);
  EXPECT_EQ(report->y, 258);
  EXPECT_EQ(report->heading, -1024);
  EXPECT_EQ(report->left_mmps, 300);
  EXPECT_EQ(report->right_mmps, -2);
  EXPECT_EQ(report->battery_dv, 126);
  EXPECT_NE(report->stalls & kPioneerLeftStall, 0);
  EXPECT_EQ(report->stalls & kPioneerRightStall, 0);
  EXPECT_EQ(pioneer_bumpers(*report), 1U << (7 + 2)) << "the third of the second group";
  EXPECT_NE(report->flags & kPioneerMotors, 0);
  EXPECT_NE(report->flags & kPioneerStopped, 0);
  EXPECT_THAT(report->echoes, ElementsAre(PioneerEcho{3, 1000}, PioneerEcho{7, 5000}));
}

TEST(PioneerProtocol, ReportsThatDoNotFitAreDropped) {
  Bytes payload = payload_by_hand();
  payload[0] = 0x90;
  EXPECT_FALSE(read(payload)) << "another packet of the server";
  payload = payload_by_hand();
  payload[19] = 3;
  EXPECT_FALSE(read(payload)) << "an echo is missing";
  payload.resize(19);
  EXPECT_FALSE(read(payload));
  payload = payload_by_hand();
  payload.insert(payload.end(), 12, 9);
  EXPECT_EQ(read(payload), read(payload_by_hand())) << "newer firmware sends more";
}

TEST(PioneerProtocol, AReportThatIsWrittenIsReadAgain) {
  const auto report = read(payload_by_hand());
  ASSERT_TRUE(report);
  EXPECT_EQ(pioneer_report(to_packet(*report)), report);
}

TEST(PioneerProtocol, PacketsAreFoundBehindNoiseAndCutPackets) {
  const Bytes& report = kReportByHand;
  Bytes stream{1, 0xFA, 0xFA, 0xFB, 2, 0xFA};
  stream.insert(stream.end(), report.begin(), report.end());
  stream.insert(stream.end(), report.begin(), report.begin() + 12);
  for (int i = 0; i < 3; ++i) stream.insert(stream.end(), report.begin(), report.end());
  PioneerReader reader;
  int found = 0;
  for (const std::uint8_t byte : stream) {
    reader.push(std::vector{byte});
    while (const auto packet = reader.next()) {
      EXPECT_EQ(to_bytes(*packet), report);
      ++found;
    }
  }
  EXPECT_EQ(found, 4);
  EXPECT_EQ(reader.counters().noise_bytes, 6U + 11U);
  EXPECT_EQ(reader.counters().bad_checksum, 1U);
}

TEST(PioneerProtocol, NoChangedBitPasses) {
  const Bytes& report = kReportByHand;
  for (std::size_t bit = 0; bit < 8 * report.size(); ++bit) {
    Bytes changed = report;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    PioneerReader reader;
    reader.push(changed);
    while (const auto packet = reader.next()) {
      EXPECT_FALSE(pioneer_report(*packet)) << bit;
    }
  }
}

}  // namespace
}  // namespace topogeo::devices
