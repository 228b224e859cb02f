// How long a navigator that has just started holds the robot, because it may have missed a stop.
#include "navigator/stop_wait.hpp"

#include <gtest/gtest.h>

namespace topogeo::navigator {
namespace {

constexpr std::int64_t kStart_ns = 5'000'000'000;
constexpr std::int64_t kEnd_ns = kStart_ns + StopWait::kLongest_ns;

TEST(StopWaitTest, EndsByItselfWithoutABaseAndAnOperator) {
  StopWait wait(kStart_ns);
  EXPECT_TRUE(wait.waits());
  EXPECT_FALSE(wait.check(kEnd_ns - 1));
  EXPECT_TRUE(wait.waits());
  EXPECT_TRUE(wait.check(kEnd_ns));
  EXPECT_FALSE(wait.waits());
  EXPECT_FALSE(wait.check(kEnd_ns + 1)) << "it ends once";
}

TEST(StopWaitTest, EndsWithTheFirstStatusOrOrder) {
  StopWait wait(kStart_ns);
  EXPECT_TRUE(wait.end());
  EXPECT_FALSE(wait.waits());
  EXPECT_FALSE(wait.end());
  EXPECT_FALSE(wait.check(kEnd_ns));
}

}  // namespace
}  // namespace topogeo::navigator
