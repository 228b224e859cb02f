// A complaint of ten seconds ago is not the reason of the present state.
#include "ros_bridge/recent_complaint.hpp"

#include <gtest/gtest.h>

namespace topogeo::ros_bridge {
namespace {

constexpr std::int64_t kSecondOfComplaint_ns = 1'000'000'000;

TEST(RecentComplaint, IsForgottenWhenItDoesNotRecur) {
  RecentComplaint complaint;
  EXPECT_EQ(complaint.text(0), "");
  complaint.add("no transform", 5 * kSecondOfComplaint_ns);
  EXPECT_EQ(complaint.text(14 * kSecondOfComplaint_ns), "no transform");
  EXPECT_EQ(complaint.text(15 * kSecondOfComplaint_ns), "");
  complaint.add("no transform", 15 * kSecondOfComplaint_ns);
  EXPECT_EQ(complaint.text(20 * kSecondOfComplaint_ns), "no transform");
}

TEST(RecentComplaint, RecursWhenItsCountGrows) {
  RecentComplaint complaint;
  EXPECT_FALSE(complaint.grows("no transform", 0));
  EXPECT_TRUE(complaint.grows("no transform", 3));
  EXPECT_FALSE(complaint.grows("no transform", 3));
  EXPECT_TRUE(complaint.grows("old stamp", 1));
  EXPECT_TRUE(complaint.grows("no transform", 4));
}

}  // namespace
}  // namespace topogeo::ros_bridge
