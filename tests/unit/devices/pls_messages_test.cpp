#include "topogeo/devices/pls_messages.hpp"

#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/devices/pls_scan.hpp"

#include "sick_streams.hpp"

namespace topogeo::devices {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatEq;

constexpr LineSettings kPls{500'000, Parity::kEven};
constexpr LineSettings kLms{500'000, Parity::kNone};

/// Owns the bytes that its telegram refers to.
class Received {
 public:
  explicit Received(const Bytes& bytes) {
    decoder_.push(bytes, 1'000'000'000);
    telegram = decoder_.next().value().telegram;
  }
  SickTelegram telegram;

 private:
  SickDecoder decoder_{SickDecoder::Listener::kHost, kByteGap_ns};
};

PlsReading plain(std::uint16_t distance) {
  return {distance, false, false, false};
}

TEST(PlsMessages, CommandsAreThoseOfTheFactsPage) {
  EXPECT_EQ(pls_mode_command(PlsMode::kInstallation, "SICK_PLS"),
            hex("02 00 0A 00 20 00 53 49 43 4B 5F 50 4C 53 CC FC"));
  EXPECT_EQ(pls_mode_command(PlsMode::kInstallation, "SICK_LMS"),
            hex("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"));
  EXPECT_EQ(pls_mode_command(PlsMode::kStream), hex("02 00 02 00 20 24 34 08"));
  EXPECT_EQ(pls_mode_command(PlsMode::kOnRequest), hex("02 00 02 00 20 25 35 08"));
  EXPECT_EQ(pls_baud_command(38400), hex("02 00 02 00 20 40 50 08"));
  EXPECT_EQ(pls_baud_command(19200), hex("02 00 02 00 20 41 51 08"));
  EXPECT_EQ(pls_baud_command(9600), hex("02 00 02 00 20 42 52 08"));
  EXPECT_EQ(pls_baud_command(500'000), hex("02 00 02 00 20 48 58 08"));
  EXPECT_FALSE(pls_baud_command(115'200));
  EXPECT_EQ(pls_baud_of(0x48), 500'000U);
  EXPECT_FALSE(pls_baud_of(0x24));
  EXPECT_EQ(pls_scan_request(), hex("02 00 02 00 30 01 31 18"));
}

TEST(PlsMessages, ReadingsCarryThreeFlags) {
  const Received received(hex("02 80 0E 00 B0 05 00 50 02 80 02 23 21 00 48 FF 9F 00 B4 96"));
  const auto values = pls_measured_values(received.telegram);
  ASSERT_TRUE(values);
  std::vector<PlsReading> readings;
  for (std::size_t i = 0; i < values->size(); ++i) readings.push_back(pls_reading(values->word(i)));
  EXPECT_THAT(readings, ElementsAre(plain(592), plain(640), PlsReading{291, true, false, false},
                                    PlsReading{2048, false, true, false},
                                    PlsReading{8191, false, false, true}));
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto code = static_cast<std::uint16_t>(word);
    ASSERT_EQ(pls_word(pls_reading(code)), code);
  }
}

TEST(PlsMessages, TheStatusByteSaysHowTheSensorIs) {
  EXPECT_EQ(pls_health(0x00), PlsHealth{});
  EXPECT_EQ(pls_health(0x10), PlsHealth{}) << "set in normal replies of an LMS";
  EXPECT_EQ(pls_health(0x83), (PlsHealth{PlsSeverity::kError, false, false, true}));
  EXPECT_EQ(pls_health(0x62), (PlsHealth{PlsSeverity::kWarning, true, true, false}));
  EXPECT_EQ(pls_health(0x07).severity, PlsSeverity::kFatal);
}

TEST(PlsMessages, RepliesToAModeSayWhatCameOfIt) {
  const auto reply = [](const char* text) { return pls_mode_reply(Received(hex(text)).telegram); };
  EXPECT_EQ(reply("02 80 03 00 A0 00 00 06 0A"), PlsModeReply::kDone);
  EXPECT_EQ(reply("02 81 03 00 A0 00 10 36 1A"), PlsModeReply::kDone);
  EXPECT_EQ(reply("02 80 03 00 A0 01 00 04 0B"), PlsModeReply::kRefused);
  EXPECT_EQ(reply("02 80 02 00 92 00 6F 33"), std::nullopt);
  EXPECT_EQ(pls_mode_reply(Received(sick_reply(0xA0, Bytes{9}, 0)).telegram), PlsModeReply::kFault);
}

TEST(PlsMessages, StatusErrorsAndPowerOnAreRead) {
  Bytes data(152);
  const std::string software = "P2.05 x";
  std::copy(software.begin(), software.end(), data.begin());
  data[115] = 0x67;
  data[116] = 0x80;
  const auto report = pls_status_report(Received(sick_reply(0xB1, data, 0x80)).telegram);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->software, software);
  EXPECT_EQ(report->baud, 9600U);
  EXPECT_TRUE(report->health.polluted);
  data[115] = 0;
  EXPECT_FALSE(pls_status_report(Received(sick_reply(0xB1, data, 0)).telegram)->baud);
  const auto brief = pls_status_report(Received(sick_reply(0xB1, Bytes{'V', '1'}, 0)).telegram);
  EXPECT_EQ(brief->software, "V1");
  EXPECT_FALSE(brief->baud);
  EXPECT_THAT(*pls_errors(Received(sick_reply(0xB2, hex("03 15 00 00 02 09 01"), 0)).telegram),
              ElementsAre(PlsError{PlsSeverity::kError, 0x15}, PlsError{PlsSeverity::kWarning, 9}));
  EXPECT_EQ(pls_power_on_text(Received(sick_reply(0x90, hex("50 4C 53 00 0A 31"), 0)).telegram),
            "PLS1");
  EXPECT_FALSE(pls_power_on_text(Received(sick_reply(0x91, hex("50"), 0)).telegram));
}

std::optional<LaserScan> scan_of(PlsScanMaker& maker, const std::vector<std::uint16_t>& words,
                                 std::uint8_t status = 0, const LineSettings& line = kPls) {
  const Received received(measured_values(words, status));
  return maker.make(pls_measured_values(received.telegram).value(), received.telegram, line);
}

TEST(LaserScan, HoldsMetresAndNoReturns) {
  const PlsSettings settings;
  PlsScanMaker maker(settings);
  std::vector<std::uint16_t> words(181, 100);
  words[0] = 0;
  words[1] = 1;
  words[2] = 4999;
  words[3] = 5000;
  words[4] = 8191;
  words[5] = pls_word({250, true, false, false});
  words[6] = pls_word({250, false, true, true});
  const auto scan = scan_of(maker, words);
  ASSERT_TRUE(scan);
  const std::vector<float> first(scan->ranges_m.begin(), scan->ranges_m.begin() + 8);
  EXPECT_THAT(first, ElementsAre(0.0F, FloatEq(0.01F), FloatEq(49.99F), 0.0F, 0.0F, 0.0F,
                                 FloatEq(2.5F), FloatEq(1.0F)));
  EXPECT_EQ(scan->dazzled, 1U);
  EXPECT_TRUE(scan->warning_field);
  EXPECT_TRUE(scan->protective_field);
  PlsSettings keep = settings;
  keep.dazzled_is_no_return = false;
  PlsScanMaker other(keep);
  EXPECT_THAT(scan_of(other, words)->ranges_m[5], FloatEq(2.5F));
}

TEST(LaserScan, IsStampedWithTheMiddleOfTheSweep) {
  const PlsSettings settings;
  PlsScanMaker maker(settings);
  // 732 bytes of 11 bits take 16.104 ms at 500000 baud; the middle of the sweep was 10 ms earlier.
  EXPECT_EQ(scan_of(maker, std::vector<std::uint16_t>(361, 1))->stamp_ns,
            1'000'000'000 - 16'104'000 - 10'000'000);
  // A second scan with the same arrival time still gets a later stamp.
  EXPECT_EQ(scan_of(maker, std::vector<std::uint16_t>(361, 2))->stamp_ns,
            1'000'000'000 - 26'104'000 + 1);
}

TEST(LaserScan, OfAnLmsMayCountInMillimetres) {
  const PlsSettings settings;
  PlsScanMaker maker(settings);
  Bytes data{181, 0x40};
  for (int i = 0; i < 181; ++i) append(data, Bytes{0xE8, 0x03});
  const Received millimetres(sick_reply(0xB0, data, 0));
  const auto values = pls_measured_values(millimetres.telegram);
  ASSERT_TRUE(values);
  EXPECT_THAT(maker.make(*values, millimetres.telegram, kLms)->ranges_m[0], FloatEq(1.0F));
  // A PLS always counts in centimetres.
  EXPECT_THAT(maker.make(*values, millimetres.telegram, kPls)->ranges_m[0], FloatEq(10.0F));
  data[1] = 0x08;
  const Received part(sick_reply(0xB0, data, 0));
  EXPECT_FALSE(maker.make(*pls_measured_values(part.telegram), part.telegram, kLms));
  EXPECT_EQ(maker.drops().interlaced, 1U);
}

TEST(LaserScan, IsDroppedForAReason) {
  PlsSettings settings;
  settings.stuck_scans = 3;
  PlsScanMaker maker(settings);
  PlsScanDrops expected;
  EXPECT_FALSE(scan_of(maker, std::vector<std::uint16_t>(100, 5)));
  expected.beam_count = 1;
  EXPECT_FALSE(scan_of(maker, std::vector<std::uint16_t>(361, 5), 0x40));
  expected.implausible = 1;
  EXPECT_FALSE(scan_of(maker, std::vector<std::uint16_t>(361, 5), 0x03));
  expected.sensor_error = 1;
  EXPECT_EQ(maker.drops(), expected);
  const std::vector<std::uint16_t> same(361, 7);
  EXPECT_TRUE(scan_of(maker, same));
  EXPECT_TRUE(scan_of(maker, same));
  EXPECT_FALSE(maker.stuck());
  EXPECT_FALSE(scan_of(maker, same));
  EXPECT_FALSE(scan_of(maker, same));
  EXPECT_TRUE(maker.stuck());
  expected.stuck = 2;
  EXPECT_EQ(maker.drops(), expected);
  std::vector<std::uint16_t> other = same;
  other[180] = 8;
  EXPECT_TRUE(scan_of(maker, other));
  EXPECT_FALSE(maker.stuck());
  // Without any return, nothing changes.
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(scan_of(maker, std::vector<std::uint16_t>(361, 8191)));
}

}  // namespace
}  // namespace topogeo::devices
