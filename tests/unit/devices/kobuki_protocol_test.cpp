// Protocol of the Kobuki: frames worked by hand from the maker's specification.
#include "topogeo/devices/kobuki_protocol.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;

using Bytes = std::vector<std::uint8_t>;

// 26 bytes of payload. Basic sensor data: 10,000 ms; central bumper; right wheel dropped; left
// cliff; left encoder 65,530, right encoder 258; powers and buttons 0; charging at the dock; 16.2
// V; overcurrent of the right motor. Inertial sensor: -10.00 degrees, rate 0.
const Bytes kReportByHand{0xAA, 0x55, 26,   1, 15, 0x10, 0x27, 2,    1, 4, 0xFA, 0xFF, 2, 1,   0, 0,
                          0,    6,    0xA2, 2, 4,  7,    0x18, 0xFC, 0, 0, 0,    0,    0, 0x63};

Bytes frame_of(const Bytes& payload) {
  return kobuki_frame(payload);
}

std::optional<KobukiReport> read(const Bytes& bytes) {
  KobukiDecoder decoder;
  decoder.push(bytes);
  return decoder.next();
}

TEST(KobukiProtocol, AReportIsReadAsWorkedByHand) {
  const auto report = read(kReportByHand);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->time_ms, 10'000);
  EXPECT_EQ(report->bumpers, 2);
  EXPECT_EQ(report->drops, 1);
  EXPECT_EQ(report->cliffs, 4);
  EXPECT_THAT(report->ticks, ElementsAre(65'530, 258));
  EXPECT_EQ(report->charger, 6);
  EXPECT_EQ(report->charger & kKobukiCable, 0U);
  EXPECT_EQ(report->battery_dv, 162);
  EXPECT_EQ(report->overcurrent, 2);
  EXPECT_EQ(report->heading_cdeg, -1000);
  EXPECT_EQ(to_bytes(*report), kReportByHand);
}

TEST(KobukiProtocol, OtherSubPayloadsAreSkipped) {
  Bytes payload{3, 3, 0, 0, 0};  // docking IR
  payload.insert(payload.end(), kReportByHand.begin() + 3, kReportByHand.end() - 1);
  payload.insert(payload.end(), {6, 2, 10, 11});  // currents
  EXPECT_EQ(read(frame_of(payload)), read(kReportByHand));
  EXPECT_FALSE(read(frame_of({10, 4, 0, 1, 1, 0}))) << "the hardware's version alone";
}

TEST(KobukiProtocol, SubPayloadsThatDoNotFitAreDropped) {
  for (const Bytes& payload :
       {Bytes{1, 15, 0}, Bytes{1, 14, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, Bytes{4, 2, 0, 0},
        Bytes{3, 1, 0, 9}}) {
    KobukiDecoder decoder;
    decoder.push(frame_of(payload));
    EXPECT_FALSE(decoder.next());
    EXPECT_EQ(decoder.counters().bad_fields, 1U);
  }
}

TEST(KobukiProtocol, FramesAreFoundBehindNoiseAndCutFrames) {
  Bytes stream{1, 0xAA, 0xAA, 0x55, 2, 0xAA, 0x55, 200};
  stream.insert(stream.end(), kReportByHand.begin(), kReportByHand.end());
  stream.insert(stream.end(), kReportByHand.begin(), kReportByHand.begin() + 12);
  stream.insert(stream.end(), kReportByHand.begin(), kReportByHand.end());
  stream.insert(stream.end(), kReportByHand.begin(), kReportByHand.end());
  KobukiDecoder decoder;
  int found = 0;
  for (const std::uint8_t byte : stream) {
    decoder.push(std::vector{byte});
    while (decoder.next()) ++found;
  }
  EXPECT_EQ(found, 3);
  EXPECT_EQ(decoder.counters().noise_bytes, 8U + 11U);
  EXPECT_EQ(decoder.counters().bad_checksum, 1U);
}

TEST(KobukiProtocol, NoChangedBitPasses) {
  for (std::size_t bit = 0; bit < 8 * kReportByHand.size(); ++bit) {
    Bytes changed = kReportByHand;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(read(changed)) << bit;
  }
}

// b = 230 mm.
TEST(KobukiProtocol, SpeedAndRadiusAreThoseOfTheMakersDriver) {
  const auto motion = [](double linear_mps, double angular_radps) {
    return kobuki_motion(linear_mps, angular_radps, 0.23);
  };
  EXPECT_EQ(motion(0.0, 0.0), (KobukiMotion{0, 0}));
  EXPECT_EQ(motion(0.3, 0.0), (KobukiMotion{300, 0}));
  EXPECT_EQ(motion(-0.3, 0.0), (KobukiMotion{-300, 0}));
  // On the spot: w b / 2.
  EXPECT_EQ(motion(0.0, 1.0), (KobukiMotion{115, 1}));
  EXPECT_EQ(motion(0.0, -1.0), (KobukiMotion{-115, 1}));
  // Radius 200 / 0.5 = 400 mm to the left; (400 + 115) * 0.5 = 257.5 mm/s.
  EXPECT_EQ(motion(0.2, 0.5), (KobukiMotion{258, 400}));
  // The same to the right: (-400 - 115) * -0.5.
  EXPECT_EQ(motion(0.2, -0.5), (KobukiMotion{258, -400}));
  EXPECT_EQ(motion(-0.2, 0.5), (KobukiMotion{-258, -400}));
  // 0.3 m/s and 0.005 rad/s: 60 m do not fit the field.
  EXPECT_EQ(motion(0.3, 0.005), (KobukiMotion{300, 0}));
  // 1.0 m/s with 4 rad/s is 1,460 mm/s at the outer wheel: radius 250 mm stays, 700 mm/s.
  EXPECT_EQ(motion(1.0, 4.0), (KobukiMotion{700, 250}));
}

TEST(KobukiProtocol, BaseControlIsThatOfTheSpecification) {
  // 300 mm/s is 0x012C, -400 mm is 0xFE70; 6 ^ 1 ^ 4 ^ 0x2C ^ 0x01 ^ 0x70 ^ 0xFE = 0xA0.
  EXPECT_THAT(to_bytes(KobukiMotion{300, -400}),
              ElementsAre(0xAA, 0x55, 6, 1, 4, 0x2C, 0x01, 0x70, 0xFE, 0xA0));
  KobukiReader reader;
  reader.push(to_bytes(KobukiMotion{-1, 2}));
  const auto payload = reader.next();
  ASSERT_TRUE(payload);
  EXPECT_EQ(kobuki_motion(*payload), (KobukiMotion{-1, 2}));
}

}  // namespace
}  // namespace topogeo::devices
