#include "topogeo/navigation/command_history.hpp"

#include <gtest/gtest.h>

namespace topogeo::navigation {
namespace {

using geometry::Pose2;

constexpr std::int64_t kTenth_ns = 100'000'000;

TEST(CommandHistory, IsEmptyBeforeTheFirstCommand) {
  const CommandHistory history(0.2);
  EXPECT_TRUE(history.stands());
  EXPECT_EQ(history.last(), geometry::Velocity{});
  EXPECT_EQ(history.since_last_s(kTenth_ns, 0.05), 0.05);
  EXPECT_EQ(history.predicted({1.0, 2.0, 0.5}, kTenth_ns), (Pose2{1.0, 2.0, 0.5}));
}

// 0.2 m/s for a tenth, then 0.4 m/s for two tenths; the base has obeyed commands older than 0.2 s.
TEST(CommandHistory, PredictsThePoseByTheCommandsThatAreNotObeyedYet) {
  CommandHistory history(0.2);
  history.add({0.2, 0.0}, 0);
  history.add({0.4, 0.0}, kTenth_ns);
  EXPECT_NEAR(history.predicted({}, 2 * kTenth_ns).x_m, 0.02 + 0.04, 1e-12);
  EXPECT_NEAR(history.predicted({}, 3 * kTenth_ns).x_m, 0.08, 1e-12);
  EXPECT_EQ(history.last().linear_m_per_s, 0.4);
  EXPECT_NEAR(history.since_last_s(3 * kTenth_ns, 0.05), 0.2, 1e-12);
}

TEST(CommandHistory, StandsOnceTheBaseHasObeyed) {
  CommandHistory history(0.2);
  history.add({0.2, 0.0}, 0);
  EXPECT_FALSE(history.stands());
  history.add({}, kTenth_ns);
  EXPECT_FALSE(history.stands()) << "the base may still obey the first";
  history.add({}, 2 * kTenth_ns);
  history.add({}, 3 * kTenth_ns);
  EXPECT_TRUE(history.stands());
}

}  // namespace
}  // namespace topogeo::navigation
