// Protocol of Roboteq controllers: lines from the maker's manual.
#include "topogeo/devices/roboteq_protocol.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

std::vector<RoboteqAnswer> read(RoboteqDecoder& decoder, std::string_view text) {
  std::vector<RoboteqAnswer> answers;
  decoder.push(bytes_of(text));
  while (auto answer = decoder.next()) answers.push_back(*answer);
  return answers;
}

TEST(RoboteqProtocol, AnswersAreNumbersBehindAName) {
  RoboteqDecoder decoder;
  EXPECT_THAT(
      read(decoder, "V=135:246:4730\rC=-12:2147483647\rFF=16\rRWD=300\r"),
      ElementsAre(RoboteqAnswer{"V", {135, 246, 4730}}, RoboteqAnswer{"C", {-12, 2'147'483'647}},
                  RoboteqAnswer{"FF", {16}}, RoboteqAnswer{"RWD", {300}}));
  EXPECT_EQ(decoder.counters(), RoboteqCounters());
  EXPECT_EQ(to_bytes(RoboteqAnswer{"V", {135, 246, 4730}}), bytes_of("V=135:246:4730\r"));
}

TEST(RoboteqProtocol, EchoesAndAcknowledgementsAreSkipped) {
  RoboteqDecoder decoder;
  EXPECT_THAT(read(decoder, "!S 1 20\r+\r^RWD 300\r-\r~RWD\r?C\rC=1:2\r\n\r"),
              ElementsAre(RoboteqAnswer{"C", {1, 2}}));
  EXPECT_EQ(decoder.counters(), RoboteqCounters());
}

TEST(RoboteqProtocol, OtherLinesAreDropped) {
  RoboteqDecoder decoder;
  EXPECT_THAT(read(decoder,
                   "C=1:\rC=:1\rC=1:2x\rC=99999999999\r=1\rC\rc=1\rC1=2\rC= 1\rTOOLONG=1\r"
                   "FID=Roboteq v1.6 RCB500 05/01/2016\r"),
              IsEmpty());
  EXPECT_EQ(decoder.counters().bad_lines, 11U);
  EXPECT_THAT(read(decoder, std::string(200, 'A') + "=1\rC=3:4\r"),
              ElementsAre(RoboteqAnswer{"C", {3, 4}}));
  EXPECT_EQ(decoder.counters().long_lines, 1U);
}

TEST(RoboteqProtocol, CommandsAreThoseOfTheManual) {
  EXPECT_EQ(roboteq_line({'!', "S", {2, -300}}), "!S 2 -300\r");
  EXPECT_EQ(roboteq_line({'^', "RWD", {2000}}), "^RWD 2000\r");
  EXPECT_EQ(roboteq_line({'?', "C"}), "?C\r");
  EXPECT_EQ(roboteq_order("!S 2 -300"), (RoboteqOrder{'!', "S", {2, -300}}));
  EXPECT_EQ(roboteq_order("~RWD"), (RoboteqOrder{'~', "RWD"}));
  for (const char* line : {"", "S 1 2", "!", "!1", "!S1", "!S 1 ", "!S  1", "!S 1 x", "?c"}) {
    EXPECT_FALSE(roboteq_order(line)) << line;
  }
}

}  // namespace
}  // namespace topogeo::devices
