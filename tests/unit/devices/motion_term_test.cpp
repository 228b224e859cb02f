#include "topogeo/devices/motion_term.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "topogeo/devices/mcp_units.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kNothingDue = std::numeric_limits<std::int64_t>::max();

TEST(MotionTerm, AVelocityHoldsUntilTheEarlierOfTwoDeadlines) {
  MotionTerm term{BaseSettings{}};  // 0.5 s at most
  EXPECT_EQ(term.due_ns(), kNothingDue);
  term.start_velocity(200'000'000, 0);
  EXPECT_EQ(term.due_ns(), 200'000'000);
  EXPECT_FALSE(term.expired(199'999'999));
  EXPECT_TRUE(term.expired(200'000'000));
  term.start_velocity(900'000'000, 100'000'000);
  EXPECT_EQ(term.due_ns(), 600'000'000);
  EXPECT_TRUE(term.velocity_holds());
  term.clear();
  EXPECT_FALSE(term.velocity_holds());
  EXPECT_EQ(term.due_ns(), kNothingDue);
}

TEST(MotionTerm, ARelativeMoveEndsWhenTheBaseStandsAfterItCanHaveBegun) {
  const BaseSettings settings;
  MotionTerm term{settings};
  term.start_relative(5'000'000'000);
  EXPECT_EQ(term.due_ns(), 5'000'000'000);
  EXPECT_FALSE(term.relative_ended(100, 4'000'000'000)) << "it was not sent yet";
  term.relative_sent(1'000'000'000);
  term.relative_sent(2'000'000'000);  // repeated: the first time counts
  const std::int64_t begun_ns = 1'300'000'000 + ticks_ns(report_period_ticks(settings));
  EXPECT_FALSE(term.relative_ended(3, begun_ns));
  EXPECT_FALSE(term.relative_ended(2, begun_ns + 1));
  EXPECT_TRUE(term.relative_ended(3, begun_ns + 1));
  term.clear();
  EXPECT_FALSE(term.relative_holds());
  term.relative_sent(0);
  EXPECT_FALSE(term.relative_ended(3, begun_ns + 1));
}

}  // namespace
}  // namespace topogeo::devices
