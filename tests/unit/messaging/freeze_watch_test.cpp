#include "freeze_watch.hpp"

#include <chrono>
#include <cstdlib>

#include <gtest/gtest.h>

#include "waiting.hpp"

namespace topogeo::messaging {
namespace {

TEST(FreezeWatch, NoticesThatItsProcessStoodStillForSoLong) {
  const FreezeWatch patient{std::chrono::hours(1)};
  const FreezeWatch watch{std::chrono::seconds(1)};
  // It may not have begun to watch when the process is stopped for the first time.
  const auto stand_still = [] {
    // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe)
    ASSERT_EQ(std::system("kill -STOP $PPID; sleep 2; kill -CONT $PPID"), 0);
  };
  ASSERT_TRUE(test::wait_for(
      "the watch to notice", [&] { return watch.stood_still().has_value(); }, stand_still));
  EXPECT_GE(*watch.stood_still(), std::chrono::seconds(1));
  EXPECT_FALSE(patient.stood_still());
}

}  // namespace
}  // namespace topogeo::messaging
