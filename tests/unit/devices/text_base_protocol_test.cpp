#include "topogeo/devices/text_base_protocol.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

std::vector<std::string> lines_in(TextBaseReader& reader, const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return reader.read(bytes);
}

// 0x31C3 is the published check value of CRC-16/XMODEM. 0x01 shifted through it is the polynomial.
TEST(TextBase, ChecksumIsThatOfXmodem) {
  EXPECT_EQ(text_base_crc("123456789"), 0x31C3);
  EXPECT_EQ(text_base_crc(""), 0);
  EXPECT_EQ(text_base_crc(std::string(1, '\x01')), 0x1021) << "the polynomial itself";
  EXPECT_EQ(text_base_line("123456789"), "$123456789*31C3\n");
}

TEST(TextBase, ReportsHaveTimeTicksFlagsAndPerhapsAGyro) {
  const auto plain = text_base_message("T,4294967295,-12,2147483647,5");
  ASSERT_TRUE(plain && plain->report);
  EXPECT_EQ(plain->report->time_ms, 4'294'967'295U);
  EXPECT_EQ(plain->report->ticks[0], -12);
  EXPECT_EQ(plain->report->ticks[1], 2'147'483'647);
  EXPECT_TRUE(plain->report->emergency_stop);
  EXPECT_FALSE(plain->report->watchdog);
  EXPECT_TRUE(plain->report->bumper);
  EXPECT_FALSE(plain->report->turn_mradps);
  const auto gyro = text_base_message("T,20,0,0,2,-350");
  ASSERT_TRUE(gyro && gyro->report);
  EXPECT_TRUE(gyro->report->watchdog);
  EXPECT_EQ(gyro->report->turn_mradps, -350);
}

TEST(TextBase, HelloHasAVersionAndAName) {
  const auto message = text_base_message("H,1,my base, second one");
  ASSERT_TRUE(message && message->hello);
  EXPECT_EQ(message->hello->version, 1);
  EXPECT_EQ(message->hello->name, "my base, second one");
  const auto battery = text_base_message("B,12300");
  ASSERT_TRUE(battery && battery->battery);
  EXPECT_EQ(battery->battery->millivolts, 12'300U);
  EXPECT_FALSE(battery->battery->percent);
  const auto measured = text_base_message("B,12300,64");
  ASSERT_TRUE(measured && measured->battery);
  EXPECT_EQ(measured->battery->percent, 64);
  EXPECT_EQ(to_line(*measured->battery), text_base_line("B,12300,64"));
}

TEST(TextBase, RefusesFieldsThatAreMissingOrOutOfRange) {
  for (const char* body :
       {"", "T", "T,1,2,3", "T,1,2,3,4,5,6", "T,-1,0,0,0", "T,1,2147483648,0,0", "T,1,2,x,0",
        "T,1,2,,0", "T,1,2,3,256", "T1,2,3,4", "H", "H,1", "H,x,name", "B", "B,-1", "B,1,101",
        "B,1,-1", "B,1,2,3", "T,99999999999999999999,0,0,0"}) {
    EXPECT_FALSE(text_base_message(body)) << body;
  }
  const auto unknown = text_base_message("Q,1,2");
  ASSERT_TRUE(unknown) << "a later version may say more";
  EXPECT_FALSE(unknown->hello || unknown->report || unknown->battery);
}

TEST(TextBaseReader, FindsLinesCutAnywhere) {
  const std::string text = "noise" + to_line(TextBaseReport{20, {1, 2}}) + "\r\n$T,1*0000\n";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    TextBaseReader reader;
    std::vector<std::string> bodies = lines_in(reader, text.substr(0, cut));
    for (std::string& body : lines_in(reader, text.substr(cut))) bodies.push_back(std::move(body));
    EXPECT_EQ(bodies, std::vector<std::string>{"T,20,1,2,0"}) << cut;
    EXPECT_EQ(reader.counters().noise_bytes, 5U);
    EXPECT_EQ(reader.counters().bad_checksum, 1U);
  }
}

TEST(TextBaseReader, NoSingleWrongBitPasses) {
  const std::string line = to_line(TextBaseReport{123'456, {-789, 1011}, false, false, false, 12});
  for (std::size_t bit = 0; bit < 8 * line.size(); ++bit) {
    std::string text = line;
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ 1 << bit % 8);
    TextBaseReader reader;
    EXPECT_TRUE(lines_in(reader, text + "\n").empty()) << "bit " << bit;
    EXPECT_EQ(lines_in(reader, line).size(), 1U) << "bit " << bit;
  }
}

TEST(TextBaseReader, LongLinesAndNoiseDoNotBreakIt) {
  TextBaseReader reader;
  EXPECT_TRUE(lines_in(reader, "$" + std::string(1000, 'x')).empty());
  EXPECT_EQ(reader.counters().long_lines, 1U);
  support::Random random(7);
  const std::string line = to_line(TextBaseBattery{12'000});
  for (int round = 0; round < 2000; ++round) {
    std::string text(random.below(120), '\0');
    for (char& c : text) c = static_cast<char>(random.below(256));
    EXPECT_EQ(lines_in(reader, text + line).back(), "B,12000");
  }
}

}  // namespace
}  // namespace topogeo::devices
