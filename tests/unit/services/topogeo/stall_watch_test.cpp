#include "topogeo/stall_watch.hpp"

#include <gtest/gtest.h>

namespace topogeo::cli {
namespace {

using Verdict = StallWatch::Verdict;

TEST(StallWatchTest, TellsOnceAndGivesUpLater) {
  StallWatch watch(100.0);
  EXPECT_EQ(watch.look("a", 101.0), Verdict::kMoving);
  EXPECT_EQ(watch.look("a", 101.0 + kStallTold_s - 0.1), Verdict::kMoving);
  EXPECT_EQ(watch.look("a", 101.0 + kStallTold_s), Verdict::kTell);
  EXPECT_EQ(watch.look("a", 101.0 + kStallTold_s + 1.0), Verdict::kMoving);
  EXPECT_EQ(watch.look("a", 101.0 + kStallFailed_s - 0.1), Verdict::kMoving);
  EXPECT_EQ(watch.look("a", 101.0 + kStallFailed_s), Verdict::kGiveUp);
}

TEST(StallWatchTest, ProgressStartsTheTimeAnew) {
  StallWatch watch(0.0);
  EXPECT_EQ(watch.look("a", 0.0), Verdict::kMoving);
  EXPECT_EQ(watch.look("a", kStallTold_s), Verdict::kTell);
  EXPECT_EQ(watch.look("b", kStallFailed_s), Verdict::kMoving);
  EXPECT_EQ(watch.look("b", kStallFailed_s + kStallTold_s), Verdict::kTell);
}

TEST(StallWatchTest, SilenceFromTheStartCounts) {
  StallWatch watch(0.0);
  EXPECT_EQ(watch.look("", kStallTold_s), Verdict::kTell);
}

}  // namespace
}  // namespace topogeo::cli
