#include "orders/goal_rounds.hpp"

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

Goal goal(std::uint64_t id, double wait_s = 0.0) {
  Goal out;
  out.id = id;
  out.text = std::to_string(id);
  out.wait_s = wait_s;
  return out;
}

TEST(GoalRounds, GivesAsManyRoundsAsOrdered) {
  GoalRounds rounds;
  EXPECT_FALSE(rounds.repeats());
  EXPECT_TRUE(rounds.next().empty());
  rounds.begin({goal(1), goal(2)}, 3);
  EXPECT_TRUE(rounds.repeats());
  for (const std::uint32_t round : {2U, 3U}) {
    const std::deque<Goal> goals = rounds.next();
    ASSERT_EQ(goals.size(), 2U);
    EXPECT_EQ(goals.back().text, "2");
    EXPECT_EQ(goals.front().round, round);
  }
  EXPECT_TRUE(rounds.next().empty());
}

TEST(GoalRounds, EndlessRoundsEndByAnOrderAlone) {
  GoalRounds rounds;
  rounds.begin({goal(1), goal(2)}, GoalRounds::kEndless);
  for (int i = 0; i < 2000; ++i) EXPECT_EQ(rounds.next().size(), 2U);
  rounds.end();
  EXPECT_TRUE(rounds.next().empty());
  EXPECT_FALSE(rounds.repeats());
}

TEST(GoalWait, HoldsForTheTimeOfTheGoalFromItsFirstCall) {
  GoalWait wait;
  const Goal patient = goal(1, 30.0);
  EXPECT_TRUE(wait.holds(patient, 5 * kSecond_ns));
  EXPECT_DOUBLE_EQ(wait.rest_s(15 * kSecond_ns), 20.0);
  EXPECT_TRUE(wait.holds(patient, 35 * kSecond_ns - 1));
  EXPECT_FALSE(wait.holds(patient, 35 * kSecond_ns));
  EXPECT_DOUBLE_EQ(wait.rest_s(40 * kSecond_ns), 0.0);
  EXPECT_FALSE(wait.holds(patient, 36 * kSecond_ns)) << "once for each goal";
  EXPECT_FALSE(wait.holds(goal(2), 50 * kSecond_ns)) << "no time is ordered";
  EXPECT_TRUE(wait.holds(goal(3, 30.0), 50 * kSecond_ns));
  wait.skip();
  EXPECT_FALSE(wait.holds(goal(3, 30.0), 51 * kSecond_ns));
}

}  // namespace
}  // namespace topogeo::web
