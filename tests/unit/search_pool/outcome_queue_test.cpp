#include "topogeo/search_pool/outcome_queue.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <semaphore>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "waiting.hpp"

namespace topogeo::search_pool {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class OutcomeQueueTest : public ::testing::Test {
 protected:
  void add(std::uint64_t ticket) {
    TaskRunner::Outcome outcome;
    outcome.ticket = ticket;
    queue_.add(outcome);
  }
  std::vector<std::uint64_t> take() {
    std::vector<std::uint64_t> tickets;
    for (const TaskRunner::Outcome& outcome : queue_.take()) tickets.push_back(outcome.ticket);
    return tickets;
  }

  std::atomic<int> wakes_ = 0;
  OutcomeQueue queue_{[this] { ++wakes_; }};
};

TEST_F(OutcomeQueueTest, WakesForEachOutcomeThatIsTaken) {
  for (std::uint64_t i = 0; i < 3; ++i) {
    add(i);
    EXPECT_THAT(take(), ElementsAre(i));
  }
  EXPECT_EQ(wakes_, 3);
  EXPECT_THAT(take(), IsEmpty());
}

TEST_F(OutcomeQueueTest, WakesOnceForAllThatComeBeforeTheyAreTaken) {
  for (std::uint64_t i = 0; i < 5; ++i) add(i);
  EXPECT_EQ(wakes_, 1);
  EXPECT_THAT(take(), ElementsAre(0, 1, 2, 3, 4));
}

TEST_F(OutcomeQueueTest, WakesWhenAsManyWaitAsWereAskedFor) {
  queue_.wake_at(3);
  add(0);
  add(1);
  EXPECT_EQ(wakes_, 0);
  add(2);
  EXPECT_EQ(wakes_, 1);
}

TEST_F(OutcomeQueueTest, WakesAtOnceWhenSoManyWaitAlready) {
  queue_.wake_at(5);
  add(0);
  add(1);
  queue_.wake_at(3);
  EXPECT_EQ(wakes_, 0);
  queue_.wake_at(2);
  EXPECT_EQ(wakes_, 1);
}

TEST_F(OutcomeQueueTest, DoesNotWakeForNothing) {
  queue_.wake_at(2);
  queue_.wake_at(1);
  EXPECT_EQ(wakes_, 0);
}

TEST(OutcomeQueue, WakesForAllThatSeveralSlotsFinish) {
  constexpr std::uint64_t kSlots = 4;
  constexpr std::uint64_t kTasks = 500;
  std::counting_semaphore<> woken(0);
  OutcomeQueue queue([&] { woken.release(); });
  std::vector<std::uint64_t> taken;
  const auto wake_at = [&] {
    queue.wake_at(std::min<std::size_t>(16, kSlots * kTasks - taken.size()));
  };
  wake_at();
  std::vector<std::thread> slots;
  for (std::uint64_t slot = 0; slot < kSlots; ++slot) {
    slots.emplace_back([&queue, slot] {
      for (std::uint64_t i = 0; i < kTasks; ++i) {
        TaskRunner::Outcome outcome;
        outcome.ticket = slot * kTasks + i;
        queue.add(outcome);
      }
    });
  }
  while (taken.size() < kSlots * kTasks && woken.try_acquire_for(test::hang_limit())) {
    for (const TaskRunner::Outcome& outcome : queue.take()) taken.push_back(outcome.ticket);
    if (taken.size() < kSlots * kTasks) wake_at();
  }
  for (std::thread& slot : slots) slot.join();
  ASSERT_EQ(taken.size(), kSlots * kTasks);
  std::sort(taken.begin(), taken.end());
  for (std::uint64_t i = 0; i < taken.size(); ++i) EXPECT_EQ(taken[i], i);
}

}  // namespace
}  // namespace topogeo::search_pool
