// Clients A and B have given goals 1 and 2; both are stored and reach each new planner.
#include "planner/goal_choice.hpp"

#include <gtest/gtest.h>

namespace topogeo::planner {
namespace {

msg::Goal goal(std::uint64_t id, msg::GoalKind kind = msg::kGoalPosition) {
  msg::Goal message;
  message.goal_id(id);
  message.kind(kind);
  return message;
}

msg::NavigatorStatus navigator(std::uint64_t id, msg::NavigatorState state) {
  msg::NavigatorStatus status;
  status.goal_id(id);
  status.state(state);
  return status;
}

std::uint64_t chosen(const GoalChoice& choice) {
  return choice.chosen() ? choice.chosen()->goal_id() : 0;
}

TEST(GoalChoice, WithoutANavigatorTheNewestGoalCountsUntilItIsCancelled) {
  GoalChoice choice;
  EXPECT_TRUE(choice.add(goal(1)));
  EXPECT_TRUE(choice.add(goal(2)));
  choice.cancel(goal(1, msg::kGoalCancel));
  EXPECT_EQ(chosen(choice), 2U);
  choice.cancel(goal(0, msg::kGoalCancel));
  EXPECT_EQ(chosen(choice), 0U);
}

TEST(GoalChoice, ANewPlannerTakesTheGoalThatTheNavigatorHas) {
  for (const bool status_first : {false, true}) {
    for (const std::uint64_t last : {1U, 2U}) {
      GoalChoice choice;
      const auto status = navigator(2, msg::kNavigatorDriving);
      if (status_first) choice.take(status);
      choice.add(goal(3 - last));
      choice.add(goal(last));
      if (!status_first) choice.take(status);
      EXPECT_EQ(chosen(choice), 2U) << status_first << last;
    }
  }
}

TEST(GoalChoice, AnEndedGoalIsPlannedNoMore) {
  for (const msg::NavigatorState end : {msg::kNavigatorArrived, msg::kNavigatorIdle}) {
    GoalChoice choice;
    choice.take(navigator(1, end));
    EXPECT_FALSE(choice.add(goal(1))) << "it is stored by its client";
    EXPECT_FALSE(choice.take(navigator(1, end)));
    EXPECT_EQ(chosen(choice), 0U);
  }
  GoalChoice choice;
  EXPECT_TRUE(choice.add(goal(1)));
  EXPECT_FALSE(choice.take(navigator(0, msg::kNavigatorIdle))) << "the navigator starts now";
  EXPECT_EQ(chosen(choice), 0U);
}

TEST(GoalChoice, ANewGoalCountsFromWhenTheNavigatorHasIt) {
  GoalChoice choice;
  choice.add(goal(1));
  EXPECT_FALSE(choice.take(navigator(1, msg::kNavigatorDriving)));
  EXPECT_FALSE(choice.add(goal(2)));
  EXPECT_EQ(chosen(choice), 1U) << "the robot still drives there";
  EXPECT_TRUE(choice.take(navigator(2, msg::kNavigatorStopped)));
  EXPECT_EQ(chosen(choice), 2U);
  EXPECT_FALSE(choice.take(navigator(2, msg::kNavigatorDriving))) << "it has its route";
}

TEST(GoalChoice, AGoalThatOnlyTheNavigatorKnowsNeedsItsClient) {
  GoalChoice choice;
  choice.add(goal(1));
  EXPECT_FALSE(choice.take(navigator(9, msg::kNavigatorDriving)));
  EXPECT_EQ(chosen(choice), 0U);
  EXPECT_TRUE(choice.add(goal(9)));
}

TEST(GoalChoice, TheNewestGoalCountsAgainWhenTheNavigatorIsGone) {
  GoalChoice choice;
  choice.add(goal(1));
  choice.take(navigator(1, msg::kNavigatorDriving));
  EXPECT_FALSE(choice.add(goal(2)));
  choice.lose_navigator();
  EXPECT_TRUE(choice.add(goal(3)));
  EXPECT_EQ(chosen(choice), 3U);
}

TEST(GoalChoice, KeepsTheNewestGoals) {
  GoalChoice choice;
  choice.take(navigator(0, msg::kNavigatorIdle));
  for (std::uint64_t id = 1; id <= 65; ++id) choice.add(goal(id));
  EXPECT_FALSE(choice.take(navigator(1, msg::kNavigatorDriving)));
  EXPECT_TRUE(choice.take(navigator(2, msg::kNavigatorDriving)));
}

}  // namespace
}  // namespace topogeo::planner
