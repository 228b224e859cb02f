// Timers of the middleware that are removed while others run.
#include "fast_dds/timer_waits.hpp"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include <fastdds/rtps/resources/ResourceEvent.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr double kAtOnce_ms = 0.01;

/// The timers of one participant, with the thread that runs them.
class TimerWaits : public ::testing::Test {
 protected:
  TimerWaits() {
    let_timers_end_alone();
    service_.init_thread();
  }
  ~TimerWaits() override { service_.stop_thread(); }

  /// Runs `work` once, soon; the timer continues when it returns true.
  std::unique_ptr<rtps::TimedEvent> start(const std::function<bool()>& work,
                                          double period_ms = kAtOnce_ms) {
    auto timer = std::make_unique<rtps::TimedEvent>(service_, work, period_ms);
    timer->restart_timer();
    return timer;
  }

  rtps::ResourceEvent service_;
};

/// A deadlock never ends, so the critical part of such a test runs in a process of its own, which
/// exits with 0.
class TimerWaitsDeathTest : public TimerWaits {
 protected:
  TimerWaitsDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  [[noreturn]] void remove_beside_one_at_work() {
    ::alarm(static_cast<unsigned>(test::hang_limit().count()));
    std::mutex mutex;
    std::atomic<bool> at_work = false;
    const auto other = start([] { return false; }, 1e6);
    std::unique_lock lock(mutex);
    const auto waits = start([&] {
      at_work = true;
      const std::lock_guard wait(mutex);
      at_work = false;
      return false;
    });
    while (!at_work) std::this_thread::yield();
    // A writer is removed alike, with the lock of discovery held.
    other->recreate_timer();
    const bool still = at_work;
    lock.unlock();
    while (at_work) std::this_thread::yield();
    std::_Exit(still ? 0 : 2);
  }
};

TEST_F(TimerWaitsDeathTest, OneIsRemovedWhileAnotherWaitsForALockOfTheThread) {
  EXPECT_EXIT(remove_beside_one_at_work(), ::testing::ExitedWithCode(0), "");
}

TEST_F(TimerWaits, OneThatIsAtWorkIsRemovedWhenItHasDoneItsWork) {
  std::atomic<bool> begun = false;
  std::atomic<bool> done = false;
  auto timer = start([&] {
    begun = true;
    // Long enough to reveal a removal that does not wait for it.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    done = true;
    return true;
  });
  ASSERT_TRUE(test::wait_for("the timer to begin its work", [&] { return begun.load(); }));
  timer.reset();
  EXPECT_TRUE(done);
}

TEST_F(TimerWaits, OneThatWasRemovedNeverWorksAgainAndTheOthersGoOn) {
  std::atomic<int> ticks = 0;
  const auto goes_on = start(
      [&] {
        ++ticks;
        return true;
      },
      0.1);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> period_ms(0.01, 0.1);
  std::atomic<bool> late = false;
  constexpr int kTimes = 4000;
  std::vector<std::unique_ptr<rtps::TimedEvent>> timers(8);
  std::vector<std::shared_ptr<std::atomic<bool>>> there(timers.size());
  for (int i = 0; i < kTimes; ++i) {
    const std::size_t k = static_cast<std::size_t>(i) % timers.size();
    timers[k].reset();
    if (there[k]) *there[k] = false;
    there[k] = std::make_shared<std::atomic<bool>>(true);
    timers[k] = start(
        [&late, mine = there[k]] {
          if (!*mine) late = true;
          return true;
        },
        period_ms(random));
    // Pacing: timers become due between two removals.
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
  const int before = ticks;
  EXPECT_TRUE(test::wait_for("the other timer to go on", [&] { return ticks > before + 10; }));
  timers.clear();
  EXPECT_FALSE(late);
}

}  // namespace
}  // namespace topogeo::messaging
