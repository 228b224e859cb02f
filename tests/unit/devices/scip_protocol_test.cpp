#include "topogeo/devices/scip_protocol.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::uint8_t> scip_bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

TEST(ScipProtocol, SumsAreThoseOfTheExamplesOfTheSpecification) {
  const std::pair<const char*, char> examples[] = {
      {"DMIN:20", '4'},  {"DMAX:5600", '_'}, {"AMIN:44", '7'}, {"AMAX:725", 'o'},
      {"AFRT:384", '6'}, {"SCAN:600", 'e'},  {"00", 'P'},      {"99", 'b'}};
  for (const auto& [text, sum] : examples) EXPECT_EQ(scip_sum(text), sum) << text;
}

// 1234 mm is 010011 010010: 0x13 + 0x30 and 0x12 + 0x30. 5432 mm is 000001 010100 111000. The time
// 16,000,000 ms is 111101 000010 010000 000000.
TEST(ScipProtocol, NumbersAreWorkedByHand) {
  EXPECT_EQ(scip_encode(1234, 2), "CB");
  EXPECT_EQ(scip_encode(5432, 3), "1Dh");
  EXPECT_EQ(scip_encode(16'000'000, 4), "m2@0");
  EXPECT_EQ(scip_decode("CB"), 1234U);
  EXPECT_EQ(scip_decode("1Dh"), 5432U);
  EXPECT_EQ(scip_decode("m2@0"), 16'000'000U);
  EXPECT_EQ(scip_decode("/0"), std::nullopt);
  EXPECT_EQ(scip_decode("p0"), std::nullopt);
  EXPECT_EQ(scip_decode("00000"), std::nullopt);
  for (std::uint32_t value = 0; value < (1U << 18U); value += 17) {
    EXPECT_EQ(scip_decode(scip_encode(value, 3)), value);
  }
}

TEST(ScipProtocol, TheParametersAreThoseOfTheExample) {
  const std::string text =
      "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\n"
      "ARES:1024;\\\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n";
  const auto fields = scip_fields(text, "PP");
  ASSERT_TRUE(fields);
  const auto parameters = scip_parameters(*fields);
  ASSERT_TRUE(parameters);
  EXPECT_EQ(*parameters, (ScipParameters{"URG-04LX(Hokuyo Automatic Co.,Ltd.)", 20, 5600, 1024, 44,
                                         725, 384, 600}));
  EXPECT_EQ(parameters->beams(), 682U);
  std::string damaged = text;
  damaged[damaged.find("725")] = '6';
  EXPECT_FALSE(scip_fields(damaged, "PP"));
  EXPECT_FALSE(scip_fields(text, "VV"));
}

TEST(ScipProtocol, ParametersThatNoLaserHasAreRefused) {
  const ScipParameters good{"UST", 20, 20'000, 1440, 0, 1080, 540, 2400};
  EXPECT_TRUE(scip_parameters(scip_fields_of(good)));
  ScipParameters bad = good;
  bad.last_step = 0;
  EXPECT_FALSE(scip_parameters(scip_fields_of(bad)));
  bad = good;
  bad.steps_of_turn = 1'000'000;
  EXPECT_FALSE(scip_parameters(scip_fields_of(bad)));
  bad = good;
  bad.rpm = 0;
  EXPECT_FALSE(scip_parameters(scip_fields_of(bad)));
  ScipFields missing = scip_fields_of(good);
  missing.pop_back();
  EXPECT_FALSE(scip_parameters(missing));
}

TEST(ScipProtocol, CommandsNameStepsAndScansWithoutEnd) {
  EXPECT_EQ(scip_command({ScipScanKind::kThreeCharacters, 44, 725}), "MD0044072500000");
  EXPECT_EQ(scip_command({ScipScanKind::kTwoCharacters, 0, 1080}), "MS0000108000000");
  EXPECT_EQ(scip_command({ScipScanKind::kIntensities, 0, 1080}), "ME0000108000000");
}

// Three beams of 20, 1234 and 5432 mm at 1 ms: "0001" has the sum 0xC1 & 0x3F + 0x30 = '1'; the
// data "00D0CB1Dh" has 0x30+0x30+0x44+0x30+0x43+0x42+0x31+0x44+0x68 = 0x236, so 0x36 + 0x30 = 'f'.
TEST(ScipProtocol, AScanIsWorkedByHand) {
  const ScipScanRequest request{ScipScanKind::kThreeCharacters, 10, 12};
  const std::string text = "MD0010001200000\n99b\n00011\n00D0CB1Dhf\n";
  const auto answer = scip_answer(text, scip_command(request));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, "99");
  const auto scan = scip_scan(*answer, request);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->time_ms, 1U);
  EXPECT_THAT(scan->distances_mm, ElementsAre(20, 1234, 5432));
  EXPECT_THAT(scan->intensities, IsEmpty());
  EXPECT_EQ(scip_text(scip_command(request), scip_answer_of(*scan, request)), text + '\n');
}

TEST(ScipProtocol, ScansOfEveryKindComeBack) {
  for (const auto kind :
       {ScipScanKind::kTwoCharacters, ScipScanKind::kThreeCharacters, ScipScanKind::kIntensities}) {
    const ScipScanRequest request{kind, 0, 99};
    ScipScan scan;
    scan.time_ms = 4711;
    for (std::uint32_t i = 0; i < 100; ++i) {
      scan.distances_mm.push_back(40 * i);
      if (kind == ScipScanKind::kIntensities) scan.intensities.push_back(7 * i);
    }
    const std::string text = scip_text(scip_command(request), scip_answer_of(scan, request));
    const auto answer = scip_answer(text.substr(0, text.size() - 1), scip_command(request));
    ASSERT_TRUE(answer);
    const auto again = scip_scan(*answer, request);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->time_ms, scan.time_ms);
    EXPECT_EQ(again->distances_mm, scan.distances_mm);
    EXPECT_EQ(again->intensities, scan.intensities);
    EXPECT_FALSE(scip_scan(*answer, {kind, 0, 100})) << "of another number of beams";
  }
}

TEST(ScipProtocol, NoBitOfAScanMayChange) {
  const ScipScanRequest request{ScipScanKind::kThreeCharacters, 0, 59};
  ScipScan scan;
  scan.time_ms = 1'234'567;
  for (std::uint32_t i = 0; i < 60; ++i) scan.distances_mm.push_back(1000 + 37 * i);
  const std::string text = scip_text(scip_command(request), scip_answer_of(scan, request));
  for (std::size_t at = 0; at < text.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string damaged = text;
      damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ 1U << bit);
      ScipReader reader;
      for (const std::string& message : reader.read(scip_bytes(damaged))) {
        const auto answer = scip_answer(message, scip_command(request));
        EXPECT_FALSE(answer && answer->status == "99" && scip_scan(*answer, request))
            << "bit " << bit << " of byte " << at;
      }
    }
  }
}

TEST(ScipProtocol, TheLastEchoBeginsTheAnswer) {
  const auto answer = scip_answer("noiseQT\n00P\n", "QT");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, "00");
  EXPECT_FALSE(scip_answer("QT\n", "QT"));
  EXPECT_FALSE(scip_answer("QT\n00Q\n", "QT"));
  EXPECT_EQ(scip_time_ms({"00", {"0001"}}), 1U);
  EXPECT_EQ(scip_time_ms({"01", {"0001"}}), std::nullopt);
  EXPECT_EQ(scip_time_ms({"00", {}}), std::nullopt);
}

TEST(ScipReader, CutsAtEmptyLinesAndForgetsEndlessNoise) {
  ScipReader reader;
  EXPECT_THAT(reader.read(scip_bytes("QT\n00")), IsEmpty());
  EXPECT_THAT(reader.read(scip_bytes("P\n\nVV\n00P\n\nrest")),
              ElementsAre("QT\n00P\n", "VV\n00P\n"));
  EXPECT_THAT(reader.read(scip_bytes(std::string(100'000, 'x'))), IsEmpty());
  EXPECT_GT(reader.noise_bytes(), 60'000U);
  reader.clear();
  EXPECT_THAT(reader.read(scip_bytes("QT\n00P\n\n")), ElementsAre("QT\n00P\n"));
}

}  // namespace
}  // namespace topogeo::devices
