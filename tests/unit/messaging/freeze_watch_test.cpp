#include "freeze_watch.hpp"

#include <chrono>
#include <cstdlib>
#include <stdexcept>

#include <gtest/gtest.h>

#include "waiting.hpp"

namespace topogeo::messaging {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

TEST(Standstill, IsTheLongestTimeBetweenTwoWakes) {
  const seconds waited(3);
  Standstill standstill({seconds(1000), waited});
  EXPECT_EQ(standstill.awake({milliseconds(1000'500), waited}), milliseconds(500));
  EXPECT_EQ(standstill.awake({milliseconds(1001'100), waited}), milliseconds(600));
  EXPECT_EQ(standstill.awake({milliseconds(1013'100), waited}), seconds(12));
  EXPECT_EQ(standstill.awake({milliseconds(1013'600), waited}), seconds(12)) << "of all so far";
}

TEST(Standstill, CountsHalfOfTheTimeThatAThreadWaitsForACpu) {
  Standstill standstill({seconds(1000), seconds(3)});
  EXPECT_EQ(standstill.awake({seconds(1008), seconds(11)}), seconds(4));
  EXPECT_EQ(standstill.awake({seconds(1018), seconds(13)}), seconds(9)) << "frozen for 8 s of 10";
  // A kernel that does not count suspensions, and one that counts more than the time passed.
  Standstill uncounted({seconds(1000), seconds(0)});
  EXPECT_EQ(uncounted.awake({seconds(1006), seconds(0)}), seconds(6));
  EXPECT_EQ(uncounted.awake({seconds(1020), seconds(90)}), seconds(7));
}

TEST(FreezeWatch, NoticesThatItsProcessStoodStillForSoLong) {
  const FreezeWatch patient{std::chrono::hours(1)};
  const FreezeWatch watch{seconds(1)};
  // The watch may start only after the first stop of the process.
  const auto stand_still = [] {
    // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe)
    ASSERT_EQ(std::system("kill -STOP $PPID; sleep 2; kill -CONT $PPID"), 0);
  };
  ASSERT_TRUE(test::wait_for(
      "the watch to notice", [&] { return watch.stood_still().has_value(); }, stand_still));
  EXPECT_GE(*watch.stood_still(), seconds(1));
  EXPECT_FALSE(patient.stood_still());
}

TEST(LongestFreeze, IsHalfTheLeaseOrAsTheEnvironmentSays) {
  EXPECT_EQ(longest_freeze(seconds(10), ""), seconds(5));
  EXPECT_EQ(longest_freeze(seconds(10), "30"), seconds(30));
  EXPECT_EQ(longest_freeze(seconds(10), "0"), nanoseconds::max());
  for (const char* bad : {"-1", "5 s", "half", "1e3", "99999999"}) {
    EXPECT_THROW(static_cast<void>(longest_freeze(seconds(10), bad)), std::runtime_error) << bad;
  }
}

}  // namespace
}  // namespace topogeo::messaging
