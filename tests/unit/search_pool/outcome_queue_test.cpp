#include "topogeo/search_pool/outcome_queue.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST_F(OutcomeQueueTest, LosesNothingOfSeveralSlots) {
  constexpr std::uint64_t kSlots = 4;
  constexpr std::uint64_t kTasks = 500;
  queue_.wake_at(16);
  std::vector<std::thread> slots;
  for (std::uint64_t slot = 0; slot < kSlots; ++slot) {
    slots.emplace_back([this, slot] {
      for (std::uint64_t i = 0; i < kTasks; ++i) add(slot * kTasks + i);
    });
  }
  std::vector<std::uint64_t> taken;
  // The last ones are fewer than it wakes for.
  while (taken.size() < kSlots * kTasks) {
    for (const std::uint64_t ticket : take()) taken.push_back(ticket);
    queue_.wake_at(16);
  }
  for (std::thread& slot : slots) slot.join();
  std::sort(taken.begin(), taken.end());
  for (std::uint64_t i = 0; i < taken.size(); ++i) EXPECT_EQ(taken[i], i);
}

}  // namespace
}  // namespace topogeo::search_pool
