#include "topogeo/search_pool/task_runner.hpp"

#include <condition_variable>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include "waiting.hpp"
#include "worker_fixture.hpp"

namespace topogeo::search_pool {
namespace {

using localization::MatchTask;
using ::testing::ElementsAre;

constexpr std::size_t kMemory_bytes = std::size_t{32} << 20U;

class TaskRunnerTest : public ::testing::Test {
 protected:
  void start(std::size_t slots, std::size_t bytes_per_slot = kMemory_bytes,
             SlotScheduling scheduling = SlotScheduling::kNormal) {
    runner_ = std::make_unique<TaskRunner>(slots, bytes_per_slot, scheduling,
                                           [this](TaskRunner::Outcome o) {
                                             hold_.wait();
                                             const std::lock_guard lock(mutex_);
                                             policies_.insert(sched_getscheduler(0));
                                             order_.push_back(o.ticket);
                                             outcomes_.emplace(o.ticket, std::move(o));
                                             came_.notify_all();
                                           });
  }
  bool wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    return test::wait_by(std::to_string(count) + " outcomes", [&](auto at_most) {
      return came_.wait_for(lock, at_most, [&] { return outcomes_.size() >= count; });
    });
  }
  /// Pauses each slot that has solved a task until release().
  void hold() {
    release_ = {};
    hold_ = release_.get_future().share();
  }
  void release() { release_.set_value(); }

  std::promise<void> release_ = [] {
    std::promise<void> released;
    released.set_value();
    return released;
  }();
  std::shared_future<void> hold_ = release_.get_future().share();
  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::uint64_t, TaskRunner::Outcome> outcomes_;
  std::vector<std::uint64_t> order_;
  std::set<int> policies_;  // scheduling policies of the searching threads
  std::vector<MapPointer> maps_{room(0, 0.0), room(1, 0.2), room(2, 0.4)};
  std::unique_ptr<TaskRunner> runner_;  // declared last, because its threads use the other members
};

TEST_F(TaskRunnerTest, SeveralSlotsGiveWhatOneMatcherGives) {
  start(3);
  localization::Matcher matcher;
  for (const MapPointer& map : maps_) matcher.add_map(*map);
  for (std::uint64_t i = 0; i < 40; ++i) {
    const std::string client = "client" + std::to_string(i % 3);
    runner_->add(ready_job(maps_[i % 2], maps_[1 + i % 2], i, client));
  }
  ASSERT_TRUE(wait_for(40));
  for (std::uint64_t i = 0; i < 40; ++i) {
    const MatchTask t = task(*maps_[i % 2], *maps_[1 + i % 2], i);
    const TaskRunner::Outcome& outcome = outcomes_.at(i);
    EXPECT_FALSE(outcome.failed) << outcome.message;
    EXPECT_TRUE(same(outcome.result, matcher.solve(t))) << i;
    EXPECT_EQ(outcome.result.status, localization::MatchStatus::kSolved);
  }
  EXPECT_EQ(runner_->in_hand(), 0U);
  EXPECT_GT(runner_->busy_time().count(), 0);
}

TEST_F(TaskRunnerTest, AClientWithALongQueueDoesNotKeepAnotherWaiting) {
  hold();
  start(1);
  for (std::uint64_t i = 0; i < 20; ++i) runner_->add(ready_job(maps_[0], maps_[1], i, "long"));
  for (std::uint64_t i = 100; i < 103; ++i) {
    runner_->add(ready_job(maps_[0], maps_[1], i, "short"));
  }
  release();
  ASSERT_TRUE(wait_for(23));
  // First any tasks begun before the second client came, then both in turn.
  const auto first = std::find(order_.begin(), order_.end(), 100U);
  ASSERT_LE(first - order_.begin(), 2);
  EXPECT_THAT(std::vector<std::uint64_t>(first, first + 5),
              ElementsAre(100, *(first + 1), 101, *(first + 3), 102));
}

TEST_F(TaskRunnerTest, TheTasksOfAClientThatIsGoneAreNotWorkedOn) {
  hold();
  start(1);
  runner_->add(ready_job(maps_[0], maps_[1], 0, "stays"));
  ASSERT_TRUE(
      test::wait_for("the slot to search", [&] { return runner_->busy_time().count() > 0; }));
  for (std::uint64_t i = 1; i < 4; ++i) runner_->add(ready_job(maps_[0], maps_[1], i, "goes"));
  runner_->add(ready_job(maps_[0], maps_[1], 4, "stays"));
  runner_->remove("goes");
  runner_->remove("goes");  // a second removal does nothing
  release();
  ASSERT_TRUE(wait_for(2));
  EXPECT_THAT(order_, ElementsAre(0, 4));
  EXPECT_EQ(runner_->in_hand(), 0U);
}

TEST_F(TaskRunnerTest, ANewMapOfAnIdIsUsedInEverySlot) {
  start(1);
  runner_->add(ready_job(maps_[0], maps_[1], 1));
  const MapPointer changed = room(1, 0.3);
  runner_->add(ready_job(maps_[0], changed, 2));
  runner_->add(ready_job(maps_[0], maps_[1], 3));
  ASSERT_TRUE(wait_for(3));
  localization::Matcher matcher;
  matcher.add_map(*maps_[0]);
  matcher.add_map(*changed);
  EXPECT_TRUE(same(outcomes_.at(2).result, matcher.solve(task(*maps_[0], *changed, 2))));
  matcher.add_map(*maps_[1]);
  EXPECT_TRUE(same(outcomes_.at(3).result, matcher.solve(task(*maps_[0], *maps_[1], 3))));
}

TEST_F(TaskRunnerTest, ATaskThatCannotBeSolvedSaysWhyAndTheSlotLivesOn) {
  start(1);
  ReadyJob bad = ready_job(maps_[0], maps_[1], 1);
  bad.job.task.half_width.setZero();
  runner_->add(bad);
  runner_->add(ready_job(maps_[0], maps_[1], 2));
  ASSERT_TRUE(wait_for(2));
  EXPECT_TRUE(outcomes_.at(1).failed);
  EXPECT_THAT(outcomes_.at(1).message, ::testing::HasSubstr("half_width.x is 0"));
  EXPECT_FALSE(outcomes_.at(2).failed);
}

TEST_F(TaskRunnerTest, ItEndsWithTasksInHand) {
  start(2);
  for (std::uint64_t i = 0; i < 50; ++i) runner_->add(ready_job(maps_[0], maps_[i % 3], i));
  runner_.reset();
  EXPECT_LE(outcomes_.size(), 50U);
}

TEST_F(TaskRunnerTest, OnlyThreadsThatSearchAreScheduledOtherwise) {
  const int here = sched_getscheduler(0);
  for (const auto& [scheduling, policy] : {std::pair{SlotScheduling::kNormal, SCHED_OTHER},
                                           {SlotScheduling::kBatch, SCHED_BATCH},
                                           {SlotScheduling::kIdle, SCHED_IDLE}}) {
    policies_.clear();
    outcomes_.clear();
    start(2, kMemory_bytes, scheduling);
    for (std::uint64_t i = 0; i < 4; ++i) runner_->add(ready_job(maps_[0], maps_[1], i));
    ASSERT_TRUE(wait_for(4));
    EXPECT_EQ(policies_, std::set<int>{policy});
    EXPECT_EQ(sched_getscheduler(0), here);
  }
}

TEST(TaskRunner, NeedsASlot) {
  EXPECT_THROW(TaskRunner(0, kMemory_bytes, SlotScheduling::kNormal, [](const auto&) {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::search_pool
