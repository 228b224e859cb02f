#include "orders/manual_drive.hpp"

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A guard that sees a free floor at this time.
navigation::CollisionGuard guard_at(std::int64_t now_ns,
                                    const navigation::GuardConfig& config = {}) {
  navigation::CollisionGuard guard{config};
  guard.add(navigation::OdometrySample{now_ns, {}});
  navigation::ScanPoints scan;
  scan.stamp_ns = now_ns;
  scan.points_m = {{8.0, 0.0}};
  guard.add(scan);
  return guard;
}

class Hand : public testing::Test {
 protected:
  std::optional<navigation::GuardVerdict> step(std::int64_t now_ns) {
    return drive_.step(guard_at(now_ns), now_ns, now_ns);
  }
  ManualDrive drive_{navigation::FollowerConfig{}};
};

TEST_F(Hand, LeavesTheBaseAloneUnlessHeld) {
  EXPECT_FALSE(step(100 * kMs));
}

TEST_F(Hand, DrivesWhileHeldAndStopsWhenTheMessagesEnd) {
  ASSERT_TRUE(drive_.hold(1, {0.3, 0.1}, 1000 * kMs));
  ASSERT_TRUE(step(1100 * kMs));
  EXPECT_GT(step(1200 * kMs)->allowed.linear_m_per_s, 0.1);
  const auto after = step(1301 * kMs);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->allowed, geometry::Velocity{}) << "dead man";
  ASSERT_TRUE(step(2200 * kMs)) << "zeros go on for a second";
  EXPECT_FALSE(step(2400 * kMs));
}

TEST_F(Hand, TurnsNoMoreTightlyThanTheBaseCan) {
  navigation::GuardConfig car;
  car.minimum_turning_radius_m = 0.8;
  const auto driven = [&](const geometry::Velocity& wanted) {
    drive_.hold(1, wanted, 1000 * kMs);
    return drive_.step(guard_at(1010 * kMs, car), 1010 * kMs, 1010 * kMs).value();
  };
  EXPECT_EQ(driven({0.2, 1.0}).allowed, (geometry::Velocity{0.2, 0.25}));
  EXPECT_EQ(driven({0.2, -0.1}).allowed, (geometry::Velocity{0.2, -0.1}));
  const navigation::GuardVerdict turn = driven({0.0, 1.0});
  EXPECT_EQ(turn.allowed, geometry::Velocity{});
  EXPECT_NE(turn.message.find("cannot turn on the spot"), std::string::npos);
}

TEST_F(Hand, LettingGoStopsAtOnce) {
  drive_.hold(1, {0.3, 0.0}, 1000 * kMs);
  drive_.release(2, 1010 * kMs);
  EXPECT_TRUE(drive_.held(1010 * kMs)) << "another one has let go";
  drive_.release(1, 1020 * kMs);
  EXPECT_EQ(step(1030 * kMs)->allowed, geometry::Velocity{});
}

TEST_F(Hand, AStopLetsGoForWhoeverDrives) {
  drive_.let_go(900 * kMs);
  EXPECT_FALSE(step(910 * kMs)) << "the base is left alone";
  drive_.hold(1, {0.3, 0.0}, 1000 * kMs);
  EXPECT_GT(step(1010 * kMs)->allowed.linear_m_per_s, 0.1);
  drive_.let_go(1020 * kMs);
  const auto stopped = step(1030 * kMs);
  ASSERT_TRUE(stopped) << "a base that takes no order to halt would drive on";
  EXPECT_EQ(stopped->allowed, geometry::Velocity{});
}

TEST_F(Hand, OneDrivesAtATime) {
  EXPECT_TRUE(drive_.hold(1, {0.3, 0.0}, 1000 * kMs));
  EXPECT_FALSE(drive_.hold(2, {-0.3, 0.0}, 1100 * kMs));
  EXPECT_TRUE(drive_.hold(2, {-0.3, 0.0}, 1500 * kMs)) << "the first one is gone";
}

TEST_F(Hand, GoesNoFasterThanTheNavigator) {
  drive_.hold(1, {50.0, 0.0}, 1000 * kMs);
  EXPECT_LE(step(1010 * kMs)->allowed.linear_m_per_s, navigation::FollowerConfig{}.speed_m_per_s);
}

TEST_F(Hand, WithoutSensorsItDoesNotMove) {
  drive_.hold(1, {0.3, 0.5}, 1000 * kMs);
  const navigation::CollisionGuard blind{navigation::GuardConfig{}};
  const auto verdict = drive_.step(blind, 1010 * kMs, 1010 * kMs);
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->allowed, geometry::Velocity{});
  EXPECT_FALSE(verdict->message.empty());
}

}  // namespace
}  // namespace topogeo::web
