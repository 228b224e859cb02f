// The statuses that a navigator publishes, in turn.
#include "navigator/new_arrival.hpp"

#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

namespace topogeo::navigator {
namespace {

using navigation::HaltReason;
using navigation::NavigatorState;

class NewArrivalTest : public testing::Test {
 protected:
  /// Whether the next status is an arrival.
  bool publish(std::uint64_t goal_id, NavigatorState state, HaltReason reason = HaltReason::kNone) {
    navigation::NavigatorStatus status;
    status.goal_id = goal_id;
    status.state = state;
    status.reason = reason;
    const bool arrival = is_new_arrival(status, before_);
    before_ = status;
    return arrival;
  }

 private:
  std::optional<navigation::NavigatorStatus> before_;
};

TEST_F(NewArrivalTest, IsOneOfEachGoal) {
  EXPECT_FALSE(publish(0, NavigatorState::kIdle));
  EXPECT_FALSE(publish(1, NavigatorState::kDriving));
  EXPECT_TRUE(publish(1, NavigatorState::kArrived));
  EXPECT_FALSE(publish(2, NavigatorState::kStopped, HaltReason::kWaitsForRoute));
  EXPECT_TRUE(publish(2, NavigatorState::kArrived));
  EXPECT_TRUE(publish(3, NavigatorState::kArrived)) << "no status came in between";
}

TEST_F(NewArrivalTest, IsNoPauseOrResumeAtTheGoal) {
  EXPECT_TRUE(publish(1, NavigatorState::kArrived));
  EXPECT_FALSE(publish(1, NavigatorState::kArrived, HaltReason::kPaused));
  EXPECT_FALSE(publish(1, NavigatorState::kArrived));
}

TEST_F(NewArrivalTest, IsOneAgainWhenTheRobotWasSentToTheSameGoal) {
  EXPECT_TRUE(publish(1, NavigatorState::kArrived));
  EXPECT_FALSE(publish(1, NavigatorState::kDriving));
  EXPECT_TRUE(publish(1, NavigatorState::kArrived));
}

}  // namespace
}  // namespace topogeo::navigator
