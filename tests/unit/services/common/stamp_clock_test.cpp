#include "topogeo/service/stamp_clock.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(StampClock, IsTheHostsUntilASensorSpeaks) {
  StampClock clock(500);
  EXPECT_EQ(clock.now_ns(1000), 1500);
}

TEST(StampClock, FollowsTheStampsAndTheSteadyClockBetweenThem) {
  StampClock clock(0);
  clock.observe(70 * kSecond_ns, 10 * kSecond_ns);
  EXPECT_EQ(clock.now_ns(10 * kSecond_ns), 70 * kSecond_ns);
  EXPECT_EQ(clock.now_ns(13 * kSecond_ns), 73 * kSecond_ns);
  EXPECT_FALSE(clock.take_set_back());
}

TEST(StampClock, WhatWaitedOnTheWayLooksAsOldAsItIs) {
  StampClock clock(0);
  clock.observe(70 * kSecond_ns, 10 * kSecond_ns);
  // A stall: two seconds of messages arrive at once.
  clock.observe(70 * kSecond_ns + 1, 12 * kSecond_ns);
  EXPECT_EQ(clock.now_ns(12 * kSecond_ns), 72 * kSecond_ns);
}

TEST(StampClock, FollowsAClockThatRunsSlower) {
  StampClock clock(0);
  std::int64_t largest_age_ns = 0;
  for (std::int64_t i = 0; i <= 100; ++i) {  // drifts by a millisecond a second
    const std::int64_t steady_ns = i * kSecond_ns;
    const std::int64_t stamp_ns = 50 * kSecond_ns + i * (kSecond_ns - 1'000'000);
    clock.observe(stamp_ns, steady_ns);
    largest_age_ns = std::max(largest_age_ns, clock.now_ns(steady_ns) - stamp_ns);
  }
  EXPECT_LE(largest_age_ns, 11'000'000);
  EXPECT_FALSE(clock.take_set_back());
}

TEST(StampClock, SaysOnceThatTheStampsHaveGoneBack) {
  StampClock clock(0);
  clock.observe(70 * kSecond_ns, 0);
  EXPECT_EQ(clock.now_ns(0), 70 * kSecond_ns);
  // A gateway restarts with a clock that was set back by an hour.
  for (std::int64_t second = 1; second <= 11; ++second) {
    clock.observe(-3530 * kSecond_ns + second * kSecond_ns, second * kSecond_ns);
    clock.now_ns(second * kSecond_ns);
  }
  EXPECT_TRUE(clock.take_set_back());
  EXPECT_FALSE(clock.take_set_back());
  EXPECT_EQ(clock.now_ns(11 * kSecond_ns), -3519 * kSecond_ns);
}

TEST(StampClock, NeverGoesBackALittle) {
  StampClock clock(0);
  clock.observe(70 * kSecond_ns, 0);
  std::int64_t last_ns = clock.now_ns(0);
  for (std::int64_t second = 1; second <= 20; ++second) {  // from here on half a second less
    clock.observe(70 * kSecond_ns + second * kSecond_ns - kSecond_ns / 2, second * kSecond_ns);
    const std::int64_t now_ns = clock.now_ns(second * kSecond_ns);
    EXPECT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
  EXPECT_FALSE(clock.take_set_back());
}

}  // namespace
}  // namespace topogeo::service
