// Open Interface of the Create 2: packets worked by hand from the maker's specification.
#include "topogeo/devices/create_protocol.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

using testing::ElementsAre;

using Bytes = std::vector<std::uint8_t>;

// header, 31 bytes; left bump and right wheel drop; front left cliff; full charging; 14,512 mV;
// 2,000 of 3,000 mAh; home base; safe mode; left encoder 65,530, right encoder 258; the sum is 3 *
// 256 with it.
const Bytes kFrameByHand{19, 31, 7,  6,    9,    0,    10,   1,    11, 0,    12,   0,
                         21, 2,  22, 0x38, 0xB0, 25,   0x07, 0xD0, 26, 0x0B, 0xB8, 34,
                         2,  35, 2,  43,   0xFF, 0xFA, 44,   1,    2,  0};

Bytes with_checksum(Bytes frame) {
  frame.back() = 0;
  frame.back() = create_checksum(frame);
  return frame;
}

TEST(CreateProtocol, TheExampleOfTheSpecificationHasItsChecksum) {
  // "148 2 29 13" asks for packets 29 and 13; the answer has 5 bytes, 537 and 0.
  EXPECT_EQ(create_checksum(Bytes{19, 5, 29, 2, 25, 13, 0}), 163);
}

TEST(CreateProtocol, OrdersAreThoseOfTheSpecification) {
  EXPECT_THAT(create_stream_request(),
              ElementsAre(148, 13, 7, 9, 10, 11, 12, 21, 22, 25, 26, 34, 35, 43, 44));
  // Right wheel first, high byte first: -200 mm/s is 0xFF38, 500 mm/s is 0x01F4.
  EXPECT_THAT(create_drive(500.0, -200.0), ElementsAre(145, 0xFF, 0x38, 0x01, 0xF4));
  EXPECT_THAT(create_drive(0.0, 0.0), ElementsAre(145, 0, 0, 0, 0));
}

TEST(CreateProtocol, BothWheelsAreSlowedDownTogether) {
  // 1000 and 500 mm/s: 500 and 250 turn with the same radius.
  EXPECT_THAT(create_drive(1000.0, 500.0), ElementsAre(145, 0x00, 0xFA, 0x01, 0xF4));
  EXPECT_THAT(create_drive(-1000.0, 0.0), ElementsAre(145, 0x00, 0x00, 0xFE, 0x0C));
}

TEST(CreateProtocol, AFrameIsReadAsWorkedByHand) {
  CreateDecoder decoder;
  decoder.push(with_checksum(kFrameByHand));
  const auto report = decoder.next();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->bump_left);
  EXPECT_FALSE(report->bump_right);
  EXPECT_TRUE(report->drop_right);
  EXPECT_FALSE(report->drop_left);
  EXPECT_THAT(report->cliffs, ElementsAre(false, true, false, false));
  EXPECT_EQ(report->charging, 2);
  EXPECT_EQ(report->millivolts, 14'512);
  EXPECT_EQ(report->charge_mah, 2'000);
  EXPECT_EQ(report->capacity_mah, 3'000);
  EXPECT_TRUE(report->dock);
  EXPECT_FALSE(report->charger);
  EXPECT_EQ(report->mode, 2) << "safe";
  EXPECT_THAT(report->ticks, ElementsAre(65'530, 258));
  EXPECT_EQ(to_bytes(*report), with_checksum(kFrameByHand));
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.counters(), CreateCounters());
}

TEST(CreateProtocol, FramesAreFoundBehindNoiseAndCutFrames) {
  const Bytes frame = with_checksum(kFrameByHand);
  Bytes stream{1, 19, 19, 31, 7};
  stream.insert(stream.end(), frame.begin(), frame.end());
  stream.insert(stream.end(), frame.begin(), frame.begin() + 12);
  stream.insert(stream.end(), frame.begin(), frame.end());
  CreateDecoder decoder;
  int found = 0;
  for (const std::uint8_t byte : stream) {
    decoder.push(std::vector{byte});
    while (decoder.next()) ++found;
  }
  EXPECT_EQ(found, 2);
  EXPECT_EQ(decoder.counters().noise_bytes, 5U + 12U);
}

TEST(CreateProtocol, NoChangedBitPasses) {
  const Bytes frame = with_checksum(kFrameByHand);
  for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
    Bytes changed = frame;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    CreateDecoder decoder;
    decoder.push(changed);
    EXPECT_FALSE(decoder.next()) << bit;
  }
}

TEST(CreateProtocol, ValuesThatNoDeviceSendsAreDropped) {
  const auto refused = [](std::size_t at, std::uint8_t value) {
    Bytes frame = kFrameByHand;
    frame[at] = value;
    CreateDecoder decoder;
    decoder.push(with_checksum(frame));
    return !decoder.next() && decoder.counters().bad_fields == 1;
  };
  EXPECT_TRUE(refused(3, 16));  // bumps
  EXPECT_TRUE(refused(5, 2));   // cliff
  EXPECT_TRUE(refused(13, 6));  // charging
  EXPECT_TRUE(refused(24, 4));  // sources
  EXPECT_TRUE(refused(26, 5));  // mode
}

TEST(CreateProtocol, ASlowLineGetsFewerFrames) {
  EXPECT_EQ(create_period_ms({115'200, Parity::kNone}), 15U);
  EXPECT_EQ(create_period_ms({19'200, Parity::kNone}), 30U);  // 34 bytes in 17.7 ms
  EXPECT_EQ(create_period_ms({9'600, Parity::kNone}), 45U);
}

}  // namespace
}  // namespace topogeo::devices
