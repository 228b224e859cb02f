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
  GoalMemory(path_).store(RememberedGoal{{0xfedcba9876543210ULL, true}, true, true});
  const auto read = GoalMemory(path_).load();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->order.goal_id, 0xfedcba9876543210ULL);
  EXPECT_TRUE(read->order.look_around);
  EXPECT_TRUE(read->paused);
  EXPECT_TRUE(read->stuck);
}

TEST_F(GoalMemoryTest, AGoalThatHasEndedIsNone) {
  GoalMemory memory(path_);
  memory.store(RememberedGoal{{7, false}, false, false});
  memory.store(std::nullopt);
  EXPECT_FALSE(GoalMemory(path_).load());
}

// A robot that is switched on stands.
TEST_F(GoalMemoryTest, AGoalOfBeforeARestartOfTheMachineIsNone) {
  constexpr std::uint64_t kBefore = 1;
  GoalMemory(path_, kBefore).store(RememberedGoal{{7, false}, false, false});
  EXPECT_TRUE(GoalMemory(path_, kBefore).load());
  EXPECT_FALSE(GoalMemory(path_).load());
}

TEST_F(GoalMemoryTest, ADamagedFileHasNone) {
  GoalMemory(path_).store(RememberedGoal{{7, false}, false, false});
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_FALSE(GoalMemory(path_).load());
}

TEST_F(GoalMemoryTest, WithoutAFileNothingIsKept) {
  GoalMemory memory({});
  memory.store(RememberedGoal{{7, false}, false, false});
  EXPECT_FALSE(memory.load());
}

}  // namespace
}  // namespace topogeo::navigator
