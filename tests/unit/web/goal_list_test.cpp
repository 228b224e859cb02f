#include "orders/goal_list.hpp"

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

std::deque<Goal> goals(std::initializer_list<std::uint64_t> ids) {
  std::deque<Goal> out;
  for (const std::uint64_t id : ids) out.push_back({id, std::to_string(id), {}});
  return out;
}

msg::NavigatorStatus status(std::uint64_t goal, msg::NavigatorState state,
                            msg::HaltReason reason = msg::kHaltNone) {
  msg::NavigatorStatus out;
  out.goal_id(goal);
  out.state(state);
  out.reason(reason);
  return out;
}

TEST(GoalList, GoesFromOneToTheNext) {
  GoalList list;
  EXPECT_TRUE(list.add(goals({1, 2}), false));
  EXPECT_EQ(list.current()->id, 1U);
  EXPECT_FALSE(list.add(goals({3}), true)) << "waits";
  EXPECT_EQ(list.take(status(1, msg::kNavigatorDriving)), std::nullopt);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorArrived)), GoalList::End::kArrived);
  EXPECT_EQ(list.current()->id, 2U);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorArrived)), std::nullopt) << "still the one before";
  EXPECT_EQ(list.take(status(2, msg::kNavigatorArrived)), GoalList::End::kArrived);
  EXPECT_EQ(list.take(status(3, msg::kNavigatorArrived)), GoalList::End::kArrived);
  EXPECT_FALSE(list.current());
}

TEST(GoalList, APauseAtAGoalHoldsTheNextOneBack) {
  GoalList list;
  list.add(goals({1, 2}), false);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorArrived, msg::kHaltPaused)), std::nullopt);
  EXPECT_EQ(list.current()->id, 1U);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorArrived)), GoalList::End::kArrived) << "resumed";
  EXPECT_EQ(list.current()->id, 2U);
  EXPECT_EQ(list.take(status(2, msg::kNavigatorArrived, msg::kHaltPaused)), GoalList::End::kArrived)
      << "nothing waits";
}

TEST(GoalList, APauseThatTheStatusDoesNotShowYetHoldsTheNextOneBack) {
  GoalList list;
  list.add(goals({1, 2}), false);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorDriving), true), std::nullopt);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorArrived), true), std::nullopt);
  EXPECT_EQ(list.current()->id, 1U);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorArrived), false), GoalList::End::kArrived);
  EXPECT_EQ(list.current()->id, 2U);
  EXPECT_EQ(list.take(status(2, msg::kNavigatorArrived), true), GoalList::End::kArrived)
      << "nothing waits";
}

TEST(GoalList, ANewGoalTakesThePlaceOfAll) {
  GoalList list;
  list.add(goals({1, 2}), false);
  EXPECT_TRUE(list.add(goals({5}), false));
  EXPECT_EQ(list.current()->id, 5U);
  EXPECT_TRUE(list.waiting().empty());
}

TEST(GoalList, GivesWayToOtherClients) {
  GoalList list;
  list.add(goals({1, 2}), false);
  EXPECT_EQ(list.take(status(9, msg::kNavigatorDriving)), std::nullopt) << "not taken yet";
  EXPECT_EQ(list.take(status(1, msg::kNavigatorDriving)), std::nullopt);
  EXPECT_EQ(list.take(status(9, msg::kNavigatorDriving)), GoalList::End::kTakenOver);
  EXPECT_FALSE(list.current());
  EXPECT_TRUE(list.waiting().empty());
}

TEST(GoalList, AGoalThatIsCancelledElsewhereEndsAll) {
  GoalList list;
  list.add(goals({1, 2}), false);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorStopped, msg::kHaltCancelled)),
            GoalList::End::kTakenOver);
  EXPECT_TRUE(list.waiting().empty());
}

TEST(GoalList, AGoalThatTheNavigatorNeverTakesEndsAll) {
  GoalList list;
  list.add(goals({1, 2}), false);
  std::optional<GoalList::End> end;
  int statuses = 0;
  while (!end && ++statuses < 1000) end = list.take(status(9, msg::kNavigatorDriving));
  EXPECT_EQ(end, GoalList::End::kNotTaken);
  EXPECT_GT(statuses, 25) << "the first ones may be older than the goal";
  EXPECT_FALSE(list.current());
  EXPECT_TRUE(list.waiting().empty());
}

TEST(GoalList, ABlockedGoalStays) {
  GoalList list;
  list.add(goals({1}), false);
  EXPECT_EQ(list.take(status(1, msg::kNavigatorStopped, msg::kHaltNoRoute)), std::nullopt);
  EXPECT_EQ(list.current()->id, 1U);
}

}  // namespace
}  // namespace topogeo::web
