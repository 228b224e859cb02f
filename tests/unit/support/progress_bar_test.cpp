#include "topogeo/support/progress_bar.hpp"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>

namespace topogeo::support {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;

TEST(ProgressBar, ShowsFractionRateAndTimeLeft) {
  std::ostringstream out;
  ProgressBar bar(out, true, "mapping", "scans");
  bar.update(300, 1200, 2.0);  // 150 per s, 900 to go
  EXPECT_THAT(
      out.str(),
      StrEq("\rmapping [######..................]  25 % 300/1200 scans, 150 per s, 6 s left"));
}

TEST(ProgressBar, RedrawsATerminalAtMostTenTimesASecond) {
  std::ostringstream out;
  ProgressBar bar(out, true, "x", "scans");
  for (std::uint64_t i = 0; i < 1000; ++i) bar.update(i, 1000, static_cast<double>(i) * 1e-3);
  const std::string text = out.str();
  EXPECT_LE(std::ranges::count(text, '\r'), 10);
  EXPECT_GE(std::ranges::count(text, '\r'), 9);
  EXPECT_EQ(std::ranges::count(text, '\n'), 0);
}

TEST(ProgressBar, WipesALongerLine) {
  std::ostringstream out;
  ProgressBar bar(out, true, "x", "scans");
  bar.update(1, 1000000, 10.0);
  const std::size_t first = out.str().size();
  bar.finish(1000000, 1000000, 20.0);
  const std::string second = out.str().substr(first);
  EXPECT_EQ(second.front(), '\r');
  EXPECT_EQ(second.back(), '\n');
  EXPECT_GE(second.size(), first);
  EXPECT_THAT(second, HasSubstr("100 % 1000000/1000000 scans, 50000 per s, took 20 s"));
}

TEST(ProgressBar, PrintsOneLinePerTenthElsewhere) {
  std::ostringstream out;
  ProgressBar bar(out, false, "x", "scans");
  for (std::uint64_t i = 0; i <= 1000; ++i) bar.update(i, 1000, static_cast<double>(i));
  bar.finish(1000, 1000, 1000.0);
  const std::string text = out.str();
  EXPECT_EQ(std::ranges::count(text, '\n'), 10);
  EXPECT_EQ(std::ranges::count(text, '\r'), 0);
  EXPECT_THAT(text, HasSubstr(" 50 % 500/1000 scans, 1.0 per s, 8 min 20 s left\n"));
  EXPECT_THAT(text, HasSubstr("took 16 min 40 s\n"));
}

TEST(ProgressBar, CopesWithUnknownTotalsAndStalls) {
  std::ostringstream out;
  ProgressBar bar(out, true, "x", "scans");
  bar.update(5, 0, 1.0);
  EXPECT_THAT(out.str(), StrEq("\rx 5 scans, 5.0 per s"));
  bar.update(0, 10, 2.0);
  EXPECT_THAT(out.str(), HasSubstr("0 % 0/10 scans, 0.0 per s, time left unknown"));
  bar.finish(12, 10, 3.0);  // more than announced
  EXPECT_THAT(out.str(), HasSubstr("100 % 12/10"));
}

}  // namespace
}  // namespace topogeo::support
