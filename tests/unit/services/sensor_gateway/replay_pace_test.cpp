#include "sensor_gateway/replay_pace.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::sensor_gateway {
namespace {

constexpr std::int64_t kOneSecond_ns = 1'000'000'000;

TEST(ReplayRate, WordsAndFactors) {
  EXPECT_EQ(service::parse_rate("lossless"), std::nullopt);
  EXPECT_EQ(service::parse_rate("realtime"), 1.0);
  EXPECT_EQ(service::parse_rate("2.5"), 2.5);
  for (const char* bad : {"", "fast", "0", "-1", "1x", "nan", "1e9", "0.001"}) {
    EXPECT_THROW(service::parse_rate(bad), std::invalid_argument) << bad;
  }
}

TEST(Pace, GapsAreAsInTheLog) {
  ReplayPace pace(1.0);
  EXPECT_DOUBLE_EQ(pace.next(100 * kOneSecond_ns).after_s, 0.0);
  EXPECT_DOUBLE_EQ(pace.next(100 * kOneSecond_ns + kOneSecond_ns / 2).after_s, 0.5);
  EXPECT_DOUBLE_EQ(pace.next(103 * kOneSecond_ns).after_s, 3.0);
}

TEST(Pace, FactorDividesThem) {
  ReplayPace pace(4.0);
  pace.next(0);
  EXPECT_DOUBLE_EQ(pace.next(2 * kOneSecond_ns).after_s, 0.5);
}

TEST(Pace, LongGapsAreShortenedAndTold) {
  ReplayPace pace(1.0);
  pace.next(0);
  const ReplayPace::Due kept = pace.next(60 * kOneSecond_ns);
  EXPECT_DOUBLE_EQ(kept.after_s, 60.0);
  EXPECT_DOUBLE_EQ(kept.shortened_gap_s, 0.0);
  const ReplayPace::Due cut = pace.next(160 * kOneSecond_ns);
  EXPECT_DOUBLE_EQ(cut.after_s, 61.0);
  EXPECT_DOUBLE_EQ(cut.shortened_gap_s, 100.0);
  EXPECT_DOUBLE_EQ(pace.next(161 * kOneSecond_ns).after_s, 62.0);
}

TEST(Pace, LosslessNeverWaits) {
  ReplayPace pace(std::nullopt);
  pace.next(0);
  const ReplayPace::Due due = pace.next(1000 * kOneSecond_ns);
  EXPECT_DOUBLE_EQ(due.after_s, 0.0);
  EXPECT_DOUBLE_EQ(due.shortened_gap_s, 0.0);
}

}  // namespace
}  // namespace topogeo::sensor_gateway
