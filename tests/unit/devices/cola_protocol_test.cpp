#include "topogeo/devices/cola_protocol.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::uint8_t> cola_text(const std::string& body) {
  std::vector<std::uint8_t> bytes{0x02};
  bytes.insert(bytes.end(), body.begin(), body.end());
  bytes.push_back(0x03);
  return bytes;
}

// The examples of the operating instructions of the TiM781.
TEST(ColaProtocol, TheRequestsAreThoseOfTheInstructions) {
  EXPECT_EQ(cola_bytes({ColaDialect::kText, "sRN LMDscandata", {}}),
            (std::vector<std::uint8_t>{0x02, 0x73, 0x52, 0x4E, 0x20, 0x4C, 0x4D, 0x44, 0x73, 0x63,
                                       0x61, 0x6E, 0x64, 0x61, 0x74, 0x61, 0x03}));
  EXPECT_EQ(cola_bytes({ColaDialect::kBinary, "sRN LMDscandata", {}}),
            (std::vector<std::uint8_t>{0x02, 0x02, 0x02, 0x02, 0x00, 0x00, 0x00, 0x0F,
                                       0x73, 0x52, 0x4E, 0x20, 0x4C, 0x4D, 0x44, 0x73,
                                       0x63, 0x61, 0x6E, 0x64, 0x61, 0x74, 0x61, 0x05}));
  EXPECT_EQ(cola_bytes(ColaWriter(ColaDialect::kText).number(1, 1).telegram("sEN LMDscandata")),
            (std::vector<std::uint8_t>{0x02, 0x73, 0x45, 0x4E, 0x20, 0x4C, 0x4D, 0x44, 0x73, 0x63,
                                       0x61, 0x6E, 0x64, 0x61, 0x74, 0x61, 0x20, 0x31, 0x03}));
}

TEST(ColaProtocol, FieldsAreReadInBothDialects) {
  for (const ColaDialect dialect : {ColaDialect::kText, ColaDialect::kBinary}) {
    const ColaTelegram telegram = ColaWriter(dialect)
                                      .number(0xFFF92230, 4)
                                      .number(0xD05, 2)
                                      .real(0.1F)
                                      .text("DIST1")
                                      .sized_text("TiM 571")
                                      .number(7, 1)
                                      .telegram("sRA Test");
    ColaFields fields(telegram);
    EXPECT_EQ(static_cast<std::int32_t>(fields.number(4)), -450'000);
    EXPECT_EQ(fields.number(2), 3333U);
    EXPECT_EQ(fields.real(), 0.1F);
    EXPECT_EQ(fields.text(5), "DIST1");
    EXPECT_EQ(fields.sized_text(), "TiM 571");
    EXPECT_EQ(fields.number(1), 7U);
    EXPECT_TRUE(fields.ok());
    EXPECT_EQ(fields.number(1), 0U);
    EXPECT_FALSE(fields.ok());
  }
}

TEST(ColaProtocol, NumbersOfTextThatDoNotFitAreRefused) {
  for (const char* text : {"100", "G", "", "-", "1 2x"}) {
    const ColaTelegram telegram{ColaDialect::kText, "sRA Test", text};
    ColaFields fields(telegram);
    (void)fields.number(1);
    (void)fields.number(1);
    EXPECT_FALSE(fields.ok()) << text;
  }
  const ColaTelegram decimal{ColaDialect::kText, "sRA Test", "+10 -10"};
  ColaFields fields(decimal);
  EXPECT_EQ(fields.number(2), 10U);
  EXPECT_EQ(static_cast<std::int32_t>(fields.number(4)), -10);
}

// A scan of five beams from -45 degrees on, a third of a degree apart, at 15 Hz: 0xFFF92230 is
// -450,000 and 0xD05 3,333 ten thousandths of a degree, 0x5DC is 1,500 hundredths of a hertz.
// 0x3E8 is 1,000 mm; 0 and F are no distances.
const char* const kColaScanText =
    "sSN LMDscandata 1 1 89A27F 0 0 343 347 27477BA9 2747813B 0 0 7 0 0 5DC 36 0 1 DIST1 3F800000 "
    "00000000 FFF92230 D05 5 3E8 0 F 10 4E20 0 0 0 0 0 0";

TEST(ColaProtocol, AScanOfTextIsWorkedByHand) {
  ColaReader reader;
  const std::vector<ColaTelegram> telegrams = reader.read(cola_text(kColaScanText));
  ASSERT_THAT(telegrams, SizeIs(1));
  EXPECT_EQ(telegrams[0].name, "sSN LMDscandata");
  const auto scan = cola_scan(telegrams[0]);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->status, 0);
  EXPECT_EQ(scan->scan_counter, 0x347);
  EXPECT_EQ(scan->start_us, 0x27477BA9U);
  EXPECT_EQ(scan->sent_us - scan->start_us, 1426U);
  EXPECT_DOUBLE_EQ(scan->turns_hz, 15.0);
  EXPECT_DOUBLE_EQ(scan->first_deg, -45.0);
  EXPECT_DOUBLE_EQ(scan->step_deg, 0.3333);
  EXPECT_THAT(scan->ranges_m, ElementsAre(1.0F, 0.0F, 0.0F, 0.016F, 20.0F));
}

TEST(ColaProtocol, ScansOfOtherFormsAreRefused) {
  const std::string good = kColaScanText;
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    ColaReader reader;
    const auto telegrams = reader.read(cola_text(text));
    return telegrams.size() == 1 && !cola_scan(telegrams[0]);
  };
  EXPECT_TRUE(refused("sSN LMDscandata", "sRA DeviceIdent"));
  EXPECT_TRUE(refused("DIST1", "RSSI1"));
  EXPECT_TRUE(refused(" 5 3E8", " 6 3E8")) << "more values than there are";
  EXPECT_TRUE(refused(" D05 ", " 0 ")) << "a step of 0";
  EXPECT_TRUE(refused(" 5 3E8", " FFFF 3E8"));
  EXPECT_TRUE(refused("3F800000", "7FC00000")) << "a scale that is no number";
  EXPECT_TRUE(refused(" 0 1 DIST1", " 0 99 DIST1")) << "too many channels";
  EXPECT_TRUE(refused("4E20 0 0 0 0 0 0", "4E20"));
}

TEST(ColaProtocol, ScansComeBackInBothDialects) {
  ColaScan scan;
  scan.scan_counter = 7;
  scan.start_us = 0xFFFFFFF0U;
  scan.sent_us = 20'000;
  scan.turns_hz = 50.0;
  scan.first_deg = -45.0;
  scan.step_deg = 0.5;
  for (int i = 0; i < 541; ++i) scan.ranges_m.push_back(0.001F * static_cast<float>(500 + i));
  for (const ColaDialect dialect : {ColaDialect::kText, ColaDialect::kBinary}) {
    const std::vector<std::uint8_t> bytes = cola_bytes(cola_telegram(scan, dialect));
    ColaReader whole;
    ColaReader bytewise;
    std::vector<ColaTelegram> cut;
    for (const std::uint8_t byte : bytes) {
      for (ColaTelegram& telegram : bytewise.read({&byte, 1})) cut.push_back(std::move(telegram));
    }
    const std::vector<ColaTelegram> telegrams = whole.read(bytes);
    EXPECT_EQ(cut, telegrams);
    ASSERT_THAT(telegrams, SizeIs(1));
    const auto again = cola_scan(telegrams[0]);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->start_us, scan.start_us);
    EXPECT_EQ(again->ranges_m.size(), 541U);
    EXPECT_FLOAT_EQ(again->ranges_m[540], scan.ranges_m[540]);
    EXPECT_DOUBLE_EQ(again->first_deg, -45.0);
  }
}

TEST(ColaProtocol, NoBitOfABinaryScanMayChange) {
  ColaScan scan;
  scan.start_us = 1000;
  scan.sent_us = 20'000;
  scan.turns_hz = 15.0;
  scan.first_deg = -45.0;
  scan.step_deg = 1.0;
  scan.ranges_m.assign(30, 2.5F);
  const std::vector<std::uint8_t> bytes = cola_bytes(cola_telegram(scan, ColaDialect::kBinary));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::vector<std::uint8_t> damaged = bytes;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 1U << bit);
      ColaReader reader;
      for (const ColaTelegram& telegram : reader.read(damaged)) {
        EXPECT_FALSE(cola_scan(telegram)) << "bit " << bit << " of byte " << at;
      }
    }
  }
}

TEST(ColaReader, FindsTelegramsBehindNoise) {
  ColaReader reader;
  std::vector<std::uint8_t> bytes{0x02, 0x02, 0x07, 0xFF, 0x03};
  const std::vector<std::uint8_t> text = cola_text("sAN Run 1");
  const std::vector<std::uint8_t> binary = cola_bytes({ColaDialect::kBinary, "sAN Run", "1"});
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.insert(bytes.end(), binary.begin(), binary.end());
  EXPECT_THAT(reader.read(bytes), ElementsAre(ColaTelegram{ColaDialect::kText, "sAN Run", "1"},
                                              ColaTelegram{ColaDialect::kBinary, "sAN Run", "1"}));
  EXPECT_EQ(reader.noise_bytes(), 5U);
  EXPECT_THAT(reader.read(std::vector<std::uint8_t>(100'000, 0x02)), IsEmpty());
  EXPECT_GT(reader.noise_bytes(), 99'000U);
}

}  // namespace
}  // namespace topogeo::devices
