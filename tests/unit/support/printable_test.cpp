#include "topogeo/support/printable.hpp"

#include <string>

#include <gtest/gtest.h>

namespace topogeo::support {
namespace {

TEST(Printable, LeavesTextAsItIs) {
  EXPECT_EQ(printable("room A, 3.5 m"), "room A, 3.5 m");
  EXPECT_EQ(printable("Büro \xE2\x82\xAC"), "Büro \xE2\x82\xAC");
  EXPECT_EQ(printable("\xC2\xA0"), "\xC2\xA0");  // the first after the control characters
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, TakesAllControlCharactersAway) {
  EXPECT_EQ(printable("\x1B[2Jgone\r\nforged\t\x7F"), "?[2Jgone??forged??");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(printable("\xC2\x9B"
                      "2J \xC2\x80\xC2\x9F"),
            "?2J ??");
  EXPECT_EQ(printable("cut \xC2"), "cut \xC2");
}

}  // namespace
}  // namespace topogeo::support
