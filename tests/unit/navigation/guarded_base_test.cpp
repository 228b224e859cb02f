// A base with a laser that faces a post.
#include "guarded_base.hpp"

#include <string>

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

class GuardedBaseTest : public testing::Test {
 protected:
  void scan_at(double post_m, std::int64_t stamp_ns) {
    base.add(OdometrySample{stamp_ns, {}});
    base.add(scan_of_post(post_m, stamp_ns));
  }

  /// Ten orders a second from `from_ns` on, all disobeyed by the base.
  void order_for_2_s(std::int64_t from_ns) {
    for (int i = 0; i <= 20; ++i) {
      const std::int64_t now_ns = from_ns + i * kSecond_ns / 10;
      scan_at(5.0, now_ns);
      base.command({0.3, 0.0}, geometry::Pose2{}, now_ns);
    }
  }

  GuardedBase base{GuardConfig{}, 2.0};
  std::string message;
};

TEST_F(GuardedBaseTest, HasAReasonNotToMove) {
  EXPECT_EQ(base.halted(0, message), HaltReason::kNoScan);
  scan_at(5.0, 0);
  EXPECT_EQ(base.halted(0, message), HaltReason::kNone);
  base.add(BaseCondition{0, false, "emergency stop"});
  EXPECT_EQ(base.halted(0, message), HaltReason::kBaseNotReady);
  EXPECT_EQ(message, "the drive unit takes no orders: emergency stop");
  base.add(BaseCondition{0, true, ""});
  EXPECT_EQ(base.halted(0, message), HaltReason::kNone);
}

TEST_F(GuardedBaseTest, AStopHaltsABaseThatReportsNothing) {
  scan_at(5.0, 0);
  base.set_stopped("stopped by an operator until the release");
  EXPECT_EQ(base.halted(0, message), HaltReason::kBaseNotReady);
  EXPECT_EQ(message, "the drive unit takes no orders: stopped by an operator until the release");
  base.set_stopped("waits for an operator's stop");
  EXPECT_EQ(base.halted(0, message), HaltReason::kBaseNotReady);
  EXPECT_EQ(message, "the drive unit takes no orders: waits for an operator's stop");
  base.set_stopped({});
  EXPECT_EQ(base.halted(0, message), HaltReason::kNone);
}

TEST_F(GuardedBaseTest, IsHeldBeforeAnObstacleUntilItIsReleased) {
  scan_at(5.0, 0);
  EXPECT_FALSE(base.command({0.3, 0.0}, geometry::Pose2{}, 0).stopped);
  scan_at(0.3, kSecond_ns);
  const auto first = base.command({0.3, 0.0}, geometry::Pose2{}, kSecond_ns);
  EXPECT_TRUE(first.stopped);
  EXPECT_TRUE(first.newly_stopped);
  EXPECT_EQ(first.verdict.allowed, geometry::Velocity{});
  EXPECT_FALSE(base.held(kSecond_ns));
  const std::int64_t later_ns = kSecond_ns + kSecond_ns / 2;
  scan_at(0.3, later_ns);
  EXPECT_FALSE(base.command({0.3, 0.0}, geometry::Pose2{}, later_ns).newly_stopped);
  // An order to stand still does not end it; an order that the guard permits does.
  base.command({}, geometry::Pose2{}, later_ns);
  EXPECT_TRUE(base.held(2 * kSecond_ns));
  base.command({0.0, 0.5}, geometry::Pose2{}, later_ns);
  EXPECT_FALSE(base.held(2 * kSecond_ns));
  base.command({0.3, 0.0}, geometry::Pose2{}, later_ns);
  EXPECT_TRUE(base.held(3 * kSecond_ns));
  base.release();
  EXPECT_FALSE(base.held(3 * kSecond_ns));
}

TEST_F(GuardedBaseTest, ABaseThatDoesNotMoveIsStuckUntilItMayTryAgain) {
  order_for_2_s(0);
  EXPECT_EQ(base.halted(2 * kSecond_ns, message), HaltReason::kBaseStuck);
  EXPECT_NE(message.find("2.0 s of commands; drives on after a resume"), std::string::npos);
  base.set({}, 2 * kSecond_ns);
  EXPECT_EQ(base.halted(2 * kSecond_ns, message), HaltReason::kBaseStuck);
  base.retry();
  EXPECT_EQ(base.halted(2 * kSecond_ns, message), HaltReason::kNone);
}

TEST_F(GuardedBaseTest, AStuckBaseStaysSoInTheNextLife) {
  EXPECT_FALSE(base.is_stuck());
  order_for_2_s(0);
  EXPECT_TRUE(base.is_stuck());
  GuardedBase next{GuardConfig{}, 2.0};
  next.stay_stuck();
  next.set({true, 0.4}, kSecond_ns / 10);  // a busy machine must not make it try again
  next.set({}, kSecond_ns);
  EXPECT_TRUE(next.is_stuck());
  EXPECT_EQ(next.halted(kSecond_ns, message), HaltReason::kBaseStuck);
  next.retry();
  EXPECT_FALSE(next.is_stuck());
}

TEST_F(GuardedBaseTest, ABaseThatGetsItsOrdersLateIsTriedAgainWhenThereIsTime) {
  const MachineLoad busy{true, 0.4};
  std::int64_t now_ns = 0;
  for (int tries = 0; tries < 3; ++tries, now_ns += 3 * kSecond_ns) {
    base.set(busy, now_ns);
    order_for_2_s(now_ns);
    EXPECT_EQ(base.halted(now_ns + 2 * kSecond_ns, message), HaltReason::kBaseStuck);
    EXPECT_NE(message.find("tries again when this machine is less busy"), std::string::npos)
        << message;
    base.set(busy, now_ns + 2 * kSecond_ns);
    EXPECT_EQ(base.halted(now_ns + 2 * kSecond_ns, message), HaltReason::kBaseStuck);
    base.set({}, now_ns + 2 * kSecond_ns);
    EXPECT_EQ(base.halted(now_ns + 2 * kSecond_ns, message), HaltReason::kNone);
  }
  // After three vain attempts it waits for people.
  base.set(busy, now_ns);
  order_for_2_s(now_ns);
  EXPECT_EQ(base.halted(now_ns + 2 * kSecond_ns, message), HaltReason::kBaseStuck);
  EXPECT_NE(message.find("drives on after a resume"), std::string::npos) << message;
  base.set({}, now_ns + 2 * kSecond_ns);
  EXPECT_EQ(base.halted(now_ns + 2 * kSecond_ns, message), HaltReason::kBaseStuck);
}

TEST_F(GuardedBaseTest, ALoadThatBecomesKnownLaterCounts) {
  order_for_2_s(0);
  EXPECT_EQ(base.halted(2 * kSecond_ns, message), HaltReason::kBaseStuck);
  base.set({true, 0.4}, 3 * kSecond_ns);
  base.set({}, 4 * kSecond_ns);
  scan_at(5.0, 4 * kSecond_ns);
  EXPECT_EQ(base.halted(4 * kSecond_ns, message), HaltReason::kNone);
  order_for_2_s(20 * kSecond_ns);
  base.set({true, 0.4}, 30 * kSecond_ns);  // long after
  base.set({}, 31 * kSecond_ns);
  scan_at(5.0, 31 * kSecond_ns);
  EXPECT_EQ(base.halted(31 * kSecond_ns, message), HaltReason::kBaseStuck);
}

}  // namespace
}  // namespace topogeo::navigation
