#include "sensor_gateway/stop_count.hpp"

#include <gtest/gtest.h>

namespace topogeo::sensor_gateway {
namespace {

constexpr std::uint64_t kFirstStop = 1000;
constexpr messaging::Handle kOperatorA{{1}};
constexpr messaging::Handle kOperatorB{{2}};

class StopCountTest : public testing::Test {
 protected:
  StopCount stops_{kFirstStop};
};

TEST_F(StopCountTest, AnybodyReleasesTheStopThatHeHasSeen) {
  EXPECT_TRUE(stops_.may_release(kOperatorA, kFirstStop)) << "a stop from before this start";
  stops_.halt(kOperatorA);
  EXPECT_TRUE(stops_.may_release(kOperatorA, stops_.number()));
  EXPECT_TRUE(stops_.may_release(kOperatorB, stops_.number()));
  EXPECT_FALSE(stops_.may_release(kOperatorB, 0)) << "no stop is named";
}

TEST_F(StopCountTest, AResetFromBeforeAHaltOfAnotherIsRefused) {
  stops_.halt(kOperatorA);
  const std::uint64_t seen = stops_.number();
  stops_.halt(kOperatorA);  // while it is halted
  EXPECT_FALSE(stops_.may_release(kOperatorB, seen));
  EXPECT_FALSE(stops_.may_release(kOperatorB, stops_.number() + 1));
  EXPECT_TRUE(stops_.may_release(kOperatorB, stops_.number()));
}

TEST_F(StopCountTest, AnEmergencyStopCountsWhenItBegins) {
  stops_.emergency_stop(false);
  EXPECT_EQ(stops_.number(), kFirstStop);
  stops_.emergency_stop(true);
  const std::uint64_t number = stops_.number();
  EXPECT_FALSE(stops_.may_release(kOperatorA, kFirstStop));
  stops_.emergency_stop(true);
  EXPECT_EQ(stops_.number(), number);
  stops_.emergency_stop(false);
  EXPECT_EQ(stops_.number(), number);
  stops_.emergency_stop(true);
  EXPECT_NE(stops_.number(), number);
}

// Commands of one writer arrive in the order in which they were sent.
TEST_F(StopCountTest, AWriterNeedNotSeeItsOwnHalts) {
  stops_.halt(kOperatorB);
  const std::uint64_t seen = stops_.number();
  stops_.halt(kOperatorA);
  stops_.halt(kOperatorA);
  EXPECT_TRUE(stops_.may_release(kOperatorA, seen));
  EXPECT_FALSE(stops_.may_release(kOperatorA, kFirstStop)) << "it has not seen the halt of B";
  stops_.halt(kOperatorB);
  EXPECT_FALSE(stops_.may_release(kOperatorA, seen));
  stops_.halt(kOperatorA);
  stops_.emergency_stop(true);
  EXPECT_FALSE(stops_.may_release(kOperatorA, stops_.number() - 1));
}

}  // namespace
}  // namespace topogeo::sensor_gateway
