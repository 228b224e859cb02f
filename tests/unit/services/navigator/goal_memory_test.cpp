#include "navigator/goal_memory.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

namespace topogeo::navigator {
namespace {

class GoalMemoryTest : public testing::Test {
 protected:
  GoalMemoryTest() { std::filesystem::remove(path_); }
  ~GoalMemoryTest() override { std::filesystem::remove(path_); }

  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / "topogeo_goal_memory_test";
};

TEST_F(GoalMemoryTest, GivesTheNextNavigatorTheGoal) {
  EXPECT_FALSE(GoalMemory(path_).load());
  GoalMemory(path_).store(RememberedGoal{{0xfedcba9876543210ULL, true}, true, true, false});
  const auto read = GoalMemory(path_).load();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->order.goal_id, 0xfedcba9876543210ULL);
  EXPECT_TRUE(read->order.look_around);
  EXPECT_TRUE(read->paused);
  EXPECT_TRUE(read->stuck);
  EXPECT_FALSE(read->arrived);
}

/// A navigator that has reached goal 7.
navigation::Navigator navigator_at_goal() {
  navigation::Navigator navigator{navigation::NavigatorConfig()};
  navigator.set_goal({7, false});
  navigator.stay_arrived("arrived");
  return navigator;
}

// A list of goals and an exploration go on after a resume, not after a restart.
TEST_F(GoalMemoryTest, APauseAtTheGoalHoldsInTheNextNavigator) {
  navigation::Navigator before = navigator_at_goal();
  before.pause();
  GoalMemory(path_).store(to_remember(std::nullopt, true, before));
  const auto read = GoalMemory(path_).load();
  ASSERT_TRUE(read);
  navigation::Navigator next{navigation::NavigatorConfig()};
  restore(*read, next);
  next.step(1);
  EXPECT_EQ(next.status().state, navigation::NavigatorState::kArrived);
  EXPECT_EQ(next.status().reason, navigation::HaltReason::kPaused);
  EXPECT_EQ(next.status().goal_id, 7U);
}

TEST_F(GoalMemoryTest, AGoalThatWasReachedIsNone) {
  EXPECT_FALSE(to_remember(std::nullopt, false, navigator_at_goal()));
  const navigation::Navigator idle{navigation::NavigatorConfig()};
  EXPECT_FALSE(to_remember(std::nullopt, true, idle)) << "a pause without a goal";
}

TEST_F(GoalMemoryTest, AGoalUnderWayIsRememberedWithItsPause) {
  const auto goal = to_remember(navigation::GoalOrder{3, true}, true, navigator_at_goal());
  ASSERT_TRUE(goal);
  EXPECT_EQ(goal->order.goal_id, 3U);
  EXPECT_TRUE(goal->paused);
  EXPECT_FALSE(goal->arrived);
}

TEST_F(GoalMemoryTest, AGoalThatHasEndedIsNone) {
  GoalMemory memory(path_);
  memory.store(RememberedGoal{{7, false}, false, false, false});
  memory.store(std::nullopt);
  EXPECT_FALSE(GoalMemory(path_).load());
}

// A robot that is switched on stands.
TEST_F(GoalMemoryTest, AGoalOfBeforeARestartOfTheMachineIsNone) {
  constexpr std::uint64_t kBefore = 1;
  GoalMemory(path_, kBefore).store(RememberedGoal{{7, false}, false, false, false});
  EXPECT_TRUE(GoalMemory(path_, kBefore).load());
  EXPECT_FALSE(GoalMemory(path_).load());
}

TEST_F(GoalMemoryTest, ADamagedFileHasNone) {
  GoalMemory(path_).store(RememberedGoal{{7, false}, false, false, false});
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_FALSE(GoalMemory(path_).load());
}

TEST_F(GoalMemoryTest, WithoutAFileNothingIsKept) {
  GoalMemory memory({});
  memory.store(RememberedGoal{{7, false}, false, false, false});
  EXPECT_FALSE(memory.load());
}

}  // namespace
}  // namespace topogeo::navigator
