#include "goal_in_hand.hpp"

#include <gtest/gtest.h>

namespace topogeo::navigation {
namespace {

TEST(GoalInHand, HasNoneAtFirst) {
  GoalInHand goal;
  EXPECT_FALSE(goal.order());
  EXPECT_FALSE(goal.cancel());
  EXPECT_FALSE(goal.cancelled());
  goal.pause();
  EXPECT_FALSE(goal.paused());
}

TEST(GoalInHand, ANewGoalBeginsAfresh) {
  GoalInHand goal;
  goal.set({7, true});
  ASSERT_TRUE(goal.order());
  EXPECT_EQ(goal.order()->goal_id, 7U);
  goal.pause();
  goal.arrive();
  EXPECT_TRUE(goal.paused());
  EXPECT_TRUE(goal.arrived());
  goal.set({8, false});
  EXPECT_EQ(goal.order()->goal_id, 8U);
  EXPECT_FALSE(goal.paused());
  EXPECT_FALSE(goal.arrived());
}

TEST(GoalInHand, CancelledUntilTheNextGoal) {
  GoalInHand goal;
  goal.set({7, false});
  goal.arrive();
  EXPECT_TRUE(goal.cancel());
  EXPECT_TRUE(goal.cancelled());
  EXPECT_FALSE(goal.arrived());
  EXPECT_FALSE(goal.order());
  goal.set({8, false});
  EXPECT_FALSE(goal.cancelled());
}

}  // namespace
}  // namespace topogeo::navigation
