#include "orders/unconfirmed_release.hpp"

#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

using Outcome = UnconfirmedRelease::Outcome;

constexpr std::int64_t kNow_ns = 5'000'000'000;
constexpr std::int64_t kMoment_ns = 10'000'000;
constexpr std::int64_t kLate_ns = kNow_ns + UnconfirmedRelease::kPatience_ns;
constexpr std::uint64_t kStop = 7;

msg::BaseStatus base(msg::BaseState state, std::uint64_t stop_count = kStop) {
  msg::BaseStatus status;
  status.state(state);
  status.stop_count(stop_count);
  return status;
}

UnconfirmedRelease released_while(bool held) {
  UnconfirmedRelease release;
  release.begin(kStop, held, kNow_ns);
  return release;
}

TEST(UnconfirmedRelease, WithoutOneNothingIsReported) {
  UnconfirmedRelease release;
  EXPECT_EQ(release.take(base(msg::kBaseReady), kNow_ns), std::nullopt);
  EXPECT_EQ(release.check(kLate_ns), std::nullopt);
}

TEST(UnconfirmedRelease, IsConfirmedByABaseThatMayMove) {
  UnconfirmedRelease release = released_while(true);
  EXPECT_EQ(release.take(base(msg::kBaseHalted), kNow_ns), std::nullopt) << "sent before";
  EXPECT_EQ(release.take(base(msg::kBaseReady), kNow_ns + kMoment_ns), Outcome::kReleased);
  EXPECT_EQ(release.take(base(msg::kBaseReady), kLate_ns), std::nullopt) << "once";
  EXPECT_EQ(release.check(kLate_ns), std::nullopt);
}

TEST(UnconfirmedRelease, IsRefusedByABaseThatWasStoppedAgain) {
  UnconfirmedRelease release = released_while(true);
  EXPECT_EQ(release.take(base(msg::kBaseHalted, kStop + 1), kNow_ns), std::nullopt);
  EXPECT_EQ(release.check(kLate_ns - 1), std::nullopt);
  EXPECT_EQ(release.check(kLate_ns), Outcome::kRefused);
  EXPECT_EQ(release.take(base(msg::kBaseReady), kLate_ns), std::nullopt)
      << "another operator has released it";
}

// The gateway obeys a release that follows the same client's stop, whatever number it names.
TEST(UnconfirmedRelease, TheClientsOwnStopJustBeforeIsNoRefusal) {
  UnconfirmedRelease release = released_while(false);
  EXPECT_EQ(release.take(base(msg::kBaseMoving), kNow_ns), std::nullopt) << "sent before the stop";
  EXPECT_EQ(release.take(base(msg::kBaseHalted, kStop + 1), kNow_ns + kMoment_ns), std::nullopt);
  EXPECT_EQ(release.take(base(msg::kBaseReady, kStop + 1), kNow_ns + 2 * kMoment_ns),
            Outcome::kReleased);
}

TEST(UnconfirmedRelease, ABaseThatWasNotHeldIsReleasedByALaterStatus) {
  UnconfirmedRelease release = released_while(false);
  EXPECT_EQ(release.take(base(msg::kBaseReady), kNow_ns + UnconfirmedRelease::kOnItsWay_ns),
            Outcome::kReleased);
}

TEST(UnconfirmedRelease, SilenceIsReportedOnceAndALateConfirmationToo) {
  UnconfirmedRelease release = released_while(true);
  EXPECT_EQ(release.take(base(msg::kBaseOffline), kNow_ns + kMoment_ns), std::nullopt)
      << "a stop may hold";
  EXPECT_EQ(release.check(kLate_ns), Outcome::kUnconfirmed);
  EXPECT_EQ(release.check(kLate_ns + kMoment_ns), std::nullopt);
  EXPECT_EQ(release.take(base(msg::kBaseHalted), kLate_ns + kMoment_ns), std::nullopt);
  EXPECT_EQ(release.take(base(msg::kBaseReady), kLate_ns + 2 * kMoment_ns), Outcome::kReleased);
}

TEST(UnconfirmedRelease, AStopEndsIt) {
  UnconfirmedRelease release = released_while(true);
  release.end();
  EXPECT_EQ(release.take(base(msg::kBaseReady), kNow_ns + kMoment_ns), std::nullopt);
  EXPECT_EQ(release.check(kLate_ns), std::nullopt);
}

}  // namespace
}  // namespace topogeo::web
