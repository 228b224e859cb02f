#include "topogeo/supervision/stall_watch.hpp"

#include <gtest/gtest.h>

namespace topogeo::supervision {
namespace {

using Verdict = StallWatch::Verdict;

TEST(StallWatchTest, ReportsOnceAndGivesUpLater) {
  StallWatch watch(100.0);
  EXPECT_EQ(watch.check("a", 101.0), Verdict::kMoving);
  EXPECT_EQ(watch.check("a", 101.0 + kStallReported_s - 0.1), Verdict::kMoving);
  EXPECT_EQ(watch.check("a", 101.0 + kStallReported_s), Verdict::kReport);
  EXPECT_EQ(watch.check("a", 101.0 + kStallReported_s + 1.0), Verdict::kMoving);
  EXPECT_EQ(watch.check("a", 101.0 + kStallFailed_s - 0.1), Verdict::kMoving);
  EXPECT_EQ(watch.check("a", 101.0 + kStallFailed_s), Verdict::kGiveUp);
}

TEST(StallWatchTest, ProgressStartsTheTimeAnew) {
  StallWatch watch(0.0);
  EXPECT_EQ(watch.check("a", 0.0), Verdict::kMoving);
  EXPECT_EQ(watch.check("a", kStallReported_s), Verdict::kReport);
  EXPECT_EQ(watch.check("b", kStallFailed_s), Verdict::kMoving);
  EXPECT_EQ(watch.check("b", kStallFailed_s + kStallReported_s), Verdict::kReport);
}

TEST(StallWatchTest, SilenceFromTheStartCounts) {
  StallWatch watch(0.0);
  EXPECT_EQ(watch.check("", kStallReported_s), Verdict::kReport);
}

}  // namespace
}  // namespace topogeo::supervision
