#include "freeze_watch.hpp"

#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace topogeo::messaging {
namespace {

using std::chrono::milliseconds;

TEST(FreezeWatch, NoticesThatItsProcessWasStopped) {
  const FreezeWatch watch{std::chrono::seconds(1)};
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  // It may not have begun to watch when the process is stopped for the first time.
  while (!watch.stood_still() && std::chrono::steady_clock::now() < end) {
    // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe)
    ASSERT_EQ(std::system("kill -STOP $PPID; sleep 2; kill -CONT $PPID"), 0);
    std::this_thread::sleep_for(milliseconds(700));
  }
  ASSERT_TRUE(watch.stood_still());
  EXPECT_GE(*watch.stood_still(), std::chrono::seconds(1));
}

TEST(FreezeWatch, AProcessThatRunsDoesNotStandStill) {
  const FreezeWatch watch{std::chrono::hours(1)};
  std::this_thread::sleep_for(milliseconds(700));
  EXPECT_FALSE(watch.stood_still());
}

}  // namespace
}  // namespace topogeo::messaging
