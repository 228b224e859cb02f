// A worker that was asked to end, on a simulated clock.
#include "topogeo/search_pool/drain_watch.hpp"

#include <gtest/gtest.h>

namespace topogeo::search_pool {
namespace {

/// Polls 128 times a second. Returns the time in seconds that the worker stays if `open` gives the
/// number of its tasks at each time.
template <class Open>
double stay_s(const Open& open, bool busy = false) {
  constexpr double kStep_s = 1.0 / 128.0;
  constexpr double kLongest_s = 10000.0;
  DrainWatch watch(0.0);
  double now_s = 0.0;
  bool goes_on = true;
  while (goes_on && now_s < kLongest_s) {
    now_s += kStep_s;
    const auto tasks = static_cast<std::size_t>(open(now_s));
    goes_on = watch.goes_on(now_s, tasks, busy);
  }
  return now_s;
}

TEST(DrainWatch, AWorkerWithoutTasksLeavesSoon) {
  EXPECT_NEAR(stay_s([](double) { return 0; }), DrainWatch::kQuiet_s, 0.01);
}

TEST(DrainWatch, TasksAreFinishedHoweverLongThatTakes) {
  // One task every nine seconds.
  const auto open = [](double now_s) { return now_s < 900.0 ? 100 - int(now_s / 9.0) : 0; };
  EXPECT_NEAR(stay_s(open), 900.0 + DrainWatch::kQuiet_s, 0.02);
}

TEST(DrainWatch, ATaskThatComesLateIsDone) {
  const auto open = [](double now_s) { return now_s > 0.02 && now_s < 2.0 ? 1 : 0; };
  EXPECT_NEAR(stay_s(open), 2.0 + DrainWatch::kQuiet_s, 0.02);
}

TEST(DrainWatch, WorkThatDoesNotGetOnIsLeft) {
  const auto open = [](double now_s) { return now_s < 3.0 ? 5 : 4; };
  EXPECT_NEAR(stay_s(open), 3.0 + DrainWatch::kStuck_s, 0.02);
}

TEST(DrainWatch, TasksWithoutEndAreLeft) {
  const auto open = [](double now_s) { return 3 + int(100.0 * now_s) % 50; };
  EXPECT_NEAR(stay_s(open), DrainWatch::kStuck_s, 0.1);
}

TEST(DrainWatch, OnABusyMachineItMayTakeSixTimesAsLong) {
  const auto one = [](double) { return 1; };
  EXPECT_NEAR(stay_s(one, true), 6.0 * DrainWatch::kStuck_s, 0.1);
}

TEST(DrainWatch, ATimeInWhichTheWorkerStoodStillIsOneSecond) {
  DrainWatch watch(0.0);
  EXPECT_TRUE(watch.goes_on(0.01, 3, false));
  EXPECT_TRUE(watch.goes_on(3600.0, 3, false));
}

}  // namespace
}  // namespace topogeo::search_pool
