#include "topogeo/service/command_ages.hpp"

#include <optional>

#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

constexpr std::int64_t kMilli_ns = 1'000'000;
/// Offset from the steady clock to the clock of the gateway's stamps.
constexpr std::int64_t kOwnClock_ns = 1'700'000'000'000'000'000;

messaging::Handle handle(std::uint8_t number) {
  messaging::Handle handle;
  handle.bytes[0] = number;
  return handle;
}

/// A program that commands twenty times a second on its own clock.
class CommandAgesTest : public ::testing::Test {
 protected:
  /// Age of a command that arrives now and was made `late_ms` ago.
  std::optional<std::int64_t> age_ms(std::int64_t late_ms, std::int64_t clock_ns = kOwnClock_ns,
                                     std::uint8_t sender = 1) {
    const auto age_ns = ages_.age_ns(handle(sender), now_ns_ - late_ms * kMilli_ns + clock_ns,
                                     now_ns_, now_ns_ + kOwnClock_ns);
    if (!age_ns) return std::nullopt;
    return *age_ns / kMilli_ns;
  }
  void pass_ms(std::int64_t milliseconds) { now_ns_ += milliseconds * kMilli_ns; }
  void command_for_ms(std::int64_t milliseconds, std::int64_t clock_ns) {
    for (std::int64_t passed = 0; passed < milliseconds; passed += 50) {
      (void)age_ms(1, clock_ns);
      pass_ms(50);
    }
  }

  CommandAges ages_;
  std::int64_t now_ns_ = 50'000'000'000;
};

TEST_F(CommandAgesTest, TheFirstCommandByTheGatewaysClockIsAsOldAsItsStamp) {
  EXPECT_EQ(age_ms(10), 10);
  EXPECT_EQ(age_ms(250, kOwnClock_ns, 2), 250);
  EXPECT_EQ(age_ms(-20, kOwnClock_ns, 3), 0) << "a clock that is a little ahead";
}

TEST_F(CommandAgesTest, NothingIsKnownOfTheFirstCommandsByAnotherClock) {
  EXPECT_EQ(age_ms(5000), std::nullopt) << "old, or from a host whose clock is behind";
  EXPECT_EQ(age_ms(0, 0, 2), std::nullopt) << "a stamp that counts from somewhere else";
}

TEST_F(CommandAgesTest, TheQuickestCommandShowsHowTheClocksDiffer) {
  for (const std::int64_t clock_ns :
       {std::int64_t{0}, kOwnClock_ns + 3'600'000'000'000, kOwnClock_ns - 3'600'000'000'000}) {
    CommandAges fresh;
    std::swap(ages_, fresh);
    command_for_ms(400, clock_ns);
    EXPECT_EQ(age_ms(1, clock_ns), 0);
    EXPECT_EQ(age_ms(201, clock_ns), 200);
    EXPECT_EQ(age_ms(501, clock_ns), 500);
  }
}

TEST_F(CommandAgesTest, WhatWaitedWhileTheGatewayWasFrozenIsOldHoweverLongThatWas) {
  for (const std::int64_t clock_ns : {kOwnClock_ns, std::int64_t{0}}) {
    for (const std::int64_t frozen_ms : {400, 900, 1100, 6000, 60'000}) {
      command_for_ms(1000, clock_ns);
      pass_ms(frozen_ms);
      const auto age = age_ms(frozen_ms, clock_ns);
      EXPECT_TRUE(!age || *age > 300) << frozen_ms;
      pass_ms(50);
      if (clock_ns == kOwnClock_ns) {
        EXPECT_LE(age_ms(1, clock_ns).value_or(1000), 1) << "the next one is fresh " << frozen_ms;
      }
    }
  }
}

TEST_F(CommandAgesTest, AQueueOfOldCommandsGivesNoneAway) {
  for (std::int64_t late_ms = 5000; late_ms > 400; late_ms -= 50) {
    const auto age = age_ms(late_ms);
    EXPECT_TRUE(!age || *age > 300) << late_ms;
  }
  EXPECT_EQ(age_ms(5), 5);
}

TEST_F(CommandAgesTest, AClockThatIsSetIsLearntAgain) {
  command_for_ms(5000, kOwnClock_ns + 7'000'000'000);
  const std::int64_t set_back_ns = kOwnClock_ns + 2'000'000'000;
  int refused = 0;
  for (int i = 0; i < 100; ++i) {
    const auto age = age_ms(1, set_back_ns);
    if (!age || *age > 300) ++refused;
    pass_ms(50);
  }
  EXPECT_GT(refused, 30);
  EXPECT_LT(refused, 60) << "2 s until it is noticed, 0.3 s until the new one is known";
  EXPECT_EQ(age_ms(1, set_back_ns), 0);
}

TEST_F(CommandAgesTest, ASteadyDelayIsNoOtherClock) {
  command_for_ms(1000, kOwnClock_ns);
  for (int i = 0; i < 200; ++i) {
    const auto age = age_ms(800 + 50 * (i % 4));
    EXPECT_TRUE(!age || *age > 300) << i;
    pass_ms(50);
  }
  pass_ms(3000);  // it is no other sender after a pause
  for (int i = 0; i < 200; ++i) {
    const auto age = age_ms(800 + 50 * (i % 4));
    EXPECT_TRUE(!age || *age > 300) << i;
    pass_ms(50);
  }
  EXPECT_EQ(age_ms(1), 1) << "and fresh again without the delay";
}

TEST_F(CommandAgesTest, AClockThatIsSetFarFromTheGatewaysIsLearntAgain) {
  for (const std::int64_t set_s : {-3600, 3600, 2}) {
    const std::int64_t set_ns = set_s * 1'000'000'000;
    CommandAges fresh;
    std::swap(ages_, fresh);
    command_for_ms(1000, kOwnClock_ns);
    command_for_ms(3000, kOwnClock_ns + set_ns);
    EXPECT_LE(age_ms(1, kOwnClock_ns + set_ns).value_or(1000), 1) << set_ns;
  }
}

TEST_F(CommandAgesTest, AStampThatStandsStillIsNeverFresh) {
  for (int i = 0; i < 200; ++i) {
    const auto age = ages_.age_ns(handle(1), 0, now_ns_, now_ns_ + kOwnClock_ns);
    if (i * 50 > 700) {
      EXPECT_TRUE(!age || *age > 300 * kMilli_ns) << i;
    }
    pass_ms(50);
  }
}

TEST_F(CommandAgesTest, SendersAreKeptApartAndTheirNumberIsBounded) {
  command_for_ms(1000, 0);
  EXPECT_EQ(age_ms(1, kOwnClock_ns - 60'000'000'000, 2), std::nullopt);
  EXPECT_EQ(age_ms(1, 0), 0);
  for (std::uint8_t sender = 3; sender < 200; ++sender) {
    EXPECT_EQ(age_ms(1, kOwnClock_ns, sender), 1);
  }
}

}  // namespace
}  // namespace topogeo::service
