// Growth rates of totals at given times.
#include "topogeo/messaging/total_rate.hpp"

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

const TotalRate::Time kBegin{std::chrono::hours(1)};

TEST(TotalRate, IsZeroOfOneSample) {
  TotalRate rate;
  EXPECT_EQ(rate.add(kBegin, 1'000), 0.0);
  EXPECT_EQ(rate.add(kBegin, 2'000), 0.0) << "no time has passed";
}

TEST(TotalRate, IsTheGrowthOverTheWindow) {
  TotalRate rate;
  double per_s = 0.0;
  for (int i = 0; i <= 40; ++i) {
    per_s = rate.add(kBegin + i * std::chrono::milliseconds(500), 10 + 25U * unsigned(i));
  }
  EXPECT_DOUBLE_EQ(per_s, 50.0);
}

TEST(TotalRate, ForgetsWhatWasBeforeTheWindow) {
  TotalRate rate;
  rate.add(kBegin, 0);
  EXPECT_DOUBLE_EQ(rate.add(kBegin + std::chrono::seconds(1), 1'000), 1'000.0);
  double per_s = -1.0;
  for (int i = 2; i <= 7; ++i) per_s = rate.add(kBegin + std::chrono::seconds(i), 1'000);
  EXPECT_EQ(per_s, 0.0);
}

TEST(TotalRate, AfterAPauseCountsTheTimeOfThePause) {
  TotalRate rate;
  rate.add(kBegin, 0);
  rate.add(kBegin + std::chrono::seconds(1), 10);
  EXPECT_DOUBLE_EQ(rate.add(kBegin + std::chrono::seconds(101), 110), 1.0);
}

}  // namespace
}  // namespace topogeo::messaging
