// The search pool over DDS gives the results of one process, whatever happens to workers.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <optional>

#include "pool_fixture.hpp"
#include "search_pool/worker_fixture.hpp"

namespace topogeo::test {
namespace {

using localization::MatchTask;
using std::chrono::milliseconds;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PoolWithStragglersTest : public PoolTest {
 protected:
  PoolWithStragglersTest() { board_options_.straggler_floor = milliseconds(300); }
};

TEST_F(PoolTest, TwoWorkersGiveWhatOneProcessGives) {
  publish_maps();
  start_worker("w1");
  start_worker("w2");
  ASSERT_TRUE(wait_for_workers(2) && wait_for_maps());
  const std::vector<MatchTask> tasks = tasks_on(maps_, 60);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().sent, 60U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
  EXPECT_THAT(faults_, IsEmpty());
}

class PlacesInPoolTest : public PoolTest {
 protected:
  void SetUp() override {
    PoolTest::SetUp();
    pool_->add_field(field_);
    const std::vector<Eigen::Vector2d> seen{{0.2, -1.4}, {-0.2, -1.4}, {0.1, -1.4}};
    for (const auto& question : field_->questions(seen)) {
      MatchTask& task = tasks_.emplace_back();
      task.task_id = tasks_.size();
      task.query_map_id = maps_.front()->id;
      task.places = question;
    }
  }
  void expect_right(const std::vector<localization::MatchResult>& results) {
    ASSERT_EQ(results.size(), tasks_.size());
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      EXPECT_EQ(results[i].task_id, tasks_[i].task_id);
      EXPECT_FALSE(results[i].solutions.empty());
      EXPECT_EQ(results[i].solutions, field_->answer(*tasks_[i].places));
    }
  }

  std::shared_ptr<const localization::PlaceField> field_ = search_pool::place_field();
  std::vector<MatchTask> tasks_;
};

TEST_F(PlacesInPoolTest, WorkersSearchPartsOfTheWholeMap) {
  expect_right(pool_->match(tasks_));
  EXPECT_EQ(pool_->counts().in_process, tasks_.size());
  start_worker("w1");
  start_worker("w2");
  ASSERT_TRUE(wait_for_workers(2));
  for (MatchTask& task : tasks_) task.task_id += 100;
  expect_right(pool_->match(tasks_));
  EXPECT_EQ(pool_->counts().in_process, tasks_.size());
  EXPECT_EQ(pool_->maps_sent(), 2 * field_->pieces().size());
  EXPECT_THAT(faults_, IsEmpty());
}

TEST_F(PlacesInPoolTest, AWorkerWithAWrongValueIsExcluded) {
  FakeWorker wrong(partition_, loop_, "wrong", [&](FakeWorker& self, const msg::MatchTask& task) {
    localization::MatchResult result;
    result.solutions = field_->answer(*service::from_msg(task).places);
    result.solutions.back().fitness += 1e-9;
    self.answer(task, result);
  });
  ASSERT_TRUE(wait_for_workers(1));
  expect_right(pool_->match(tasks_));
  EXPECT_EQ(pool_->counts().workers_excluded, 1U);
  EXPECT_THAT(faults_, Contains("wrong match result"));
}

// All values are right, so only a repeated search of the same part reveals the omission.
TEST_F(PlacesInPoolTest, AWorkerThatLeavesOutTheBestPlaceIsExcluded) {
  FakeWorker lazy(partition_, loop_, "lazy", [&](FakeWorker& self, const msg::MatchTask& task) {
    localization::MatchResult result;
    result.solutions = field_->answer(*service::from_msg(task).places);
    result.solutions.erase(result.solutions.begin());
    self.answer(task, result);
  });
  ASSERT_TRUE(wait_for_workers(1));
  expect_right(pool_->match(tasks_));
  EXPECT_EQ(pool_->counts().workers_excluded, 1U);
  EXPECT_THAT(faults_, Contains("different answers to a task"));
}

TEST_F(PoolTest, WithoutWorkersItSearchesItself) {
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().in_process, 30U);
}

TEST_F(PoolTest, AKilledWorkerChangesNothing) {
  publish_maps();
  start_worker("w1");
  Program& killed = start_worker("w2");
  ASSERT_TRUE(wait_for_workers(2) && wait_for_maps());
  const std::vector<MatchTask> tasks = tasks_on(maps_, 400);
  when_sent(100, [&] { killed.send_signal(SIGKILL); });
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().workers_lost, 1U);
  EXPECT_GE(pool_->counts().resent, 1U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
  EXPECT_EQ(pool_->workers(), 1U);
  EXPECT_THAT(lines_, Contains(HasSubstr(" lost with ")));
  EXPECT_GT(pool_->counts().last_recovery.count(), 0);
}

TEST_F(PoolTest, WhenTheLastWorkerIsKilledItSearchesItself) {
  publish_maps();
  Program& killed = start_worker("w1");
  ASSERT_TRUE(wait_for_workers(1));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 200);
  when_sent(50, [&] { killed.send_signal(SIGKILL); });
  expect_same(tasks, pool_->match(tasks));
  EXPECT_GE(pool_->counts().sent, 50U);
  EXPECT_GE(pool_->counts().in_process, 1U);
}

TEST_F(PoolTest, AStoppedWorkerFinishesWhatItHasInHand) {
  publish_maps();
  Program& stopped = start_worker("w1");
  start_worker("w2");
  ASSERT_TRUE(wait_for_workers(2) && wait_for_maps());
  const std::vector<MatchTask> tasks = tasks_on(maps_, 400);
  when_sent(100, [&] { stopped.send_signal(SIGTERM); });
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(stopped.wait(), 0);
  EXPECT_EQ(pool_->counts().in_process, 0U);
}

TEST_F(PoolTest, ALateWorkerGetsTheTasksThatAnotherHasNoRoomFor) {
  publish_maps();
  std::uint64_t first_id = 0;
  int received = 0;
  search_pool::BoardCounts before;
  ASSERT_TRUE(wait_for_maps_in_time([&] {
    before = pool_->counts();
    FakeWorker hanging(partition_, loop_, "hanging" + std::to_string(first_id),
                       [](FakeWorker&, const msg::MatchTask&) {});
    ASSERT_TRUE(wait_for_workers(1));
    when_sent(before.sent + 2, [&] {
      start_worker("late");
      const auto is_all_sent = [&] {
        return pool_->counts().sent >= before.sent + 40 ||
               pool_->counts().map_missing > before.map_missing;
      };
      when(is_all_sent, [&] { hanging.leave(); });
    });
    const std::vector<MatchTask> tasks = tasks_on(maps_, 40, first_id);
    first_id += 40;
    expect_same(tasks, pool_->match(tasks));
    received = hanging.received;
    end_worker();
  }));
  EXPECT_EQ(received, 2);
  EXPECT_EQ(pool_->counts().sent - before.sent, 42U);
  EXPECT_EQ(pool_->counts().in_process, before.in_process);
}

TEST_F(PoolTest, TasksWaitForMapsThatComeLate) {
  std::uint64_t first_id = 0;
  search_pool::BoardCounts before;
  ASSERT_TRUE(wait_for_maps_in_time([&] {
    before = pool_->counts();
    for (const auto& map : maps_) map_writer_.dispose(service::to_msg(*map));  // of an attempt
    start_worker("w1");
    ASSERT_TRUE(wait_for_workers(1));
    when_sent(before.sent + 1, [&] { publish_maps(); });
    const std::vector<MatchTask> tasks = tasks_on(maps_, 30, first_id);
    first_id += 30;
    expect_same(tasks, pool_->match(tasks));
    end_worker();
  }));
  EXPECT_EQ(pool_->counts().in_process, before.in_process);
}

TEST_F(PoolTest, AWorkerWithoutMapsAsksForThem) {
  std::uint64_t first_id = 0;
  std::uint64_t maps_sent = 0;
  search_pool::BoardCounts before;
  ASSERT_TRUE(wait_for_maps_in_time([&] {
    before = pool_->counts();
    maps_sent = pool_->maps_sent();
    start_worker("w1");
    ASSERT_TRUE(wait_for_workers(1));
    const std::vector<MatchTask> tasks = tasks_on(maps_, 60, first_id);
    first_id += 60;
    expect_same(tasks, pool_->match(tasks));
    end_worker();
  }));
  EXPECT_EQ(pool_->counts().in_process, before.in_process);
  EXPECT_GE(pool_->maps_sent(), maps_sent + 2);
  EXPECT_THAT(faults_, IsEmpty());
}

TEST_F(PoolTest, AMapThatNobodyKnowsIsNotSent) {
  FakeWorker asking(partition_, loop_, "asking", [&](FakeWorker& self, const msg::MatchTask& task) {
    self.request_map(9999, 1);
    self.request_map(maps_[0]->id, 1);  // with different content
    self.answer(task, {}, msg::kMatchMapMissing);
  });
  ASSERT_TRUE(wait_for_workers(1));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_GE(pool_->counts().map_missing, 1U);
  EXPECT_EQ(pool_->counts().in_process, 30U);
  ASSERT_TRUE(wait_until("two faults", [&] { return faults_.size() >= 2; }));
  EXPECT_THAT(faults_, ::testing::Each("unknown map requested"));
  EXPECT_EQ(details_[0], "worker asking: map 9999");
  EXPECT_EQ(pool_->maps_sent(), 0U);
}

TEST_F(PoolWithStragglersTest, AHangingWorkerHoldsNothingUp) {
  FakeWorker hanging(partition_, loop_, "hanging", [](FakeWorker&, const msg::MatchTask&) {});
  ASSERT_TRUE(wait_for_workers(1));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().in_process, 30U);
  EXPECT_THAT(lines_, Contains("no worker answers, searching in this process"));
  EXPECT_THAT(lines_, Contains(HasSubstr("worker hanging stalled with 2 tasks, answered elsewhere "
                                         "after ")));
  EXPECT_GE(pool_->counts().longest_recovery, milliseconds(300));
}

TEST_F(PoolTest, ADrainingWorkerGetsNoTasksButIsWaitedFor) {
  Solver solver(maps_);
  std::vector<msg::MatchTask> held;
  FakeWorker draining(partition_, loop_, "draining",
                      [&](FakeWorker&, const msg::MatchTask& task) { held.push_back(task); });
  ASSERT_TRUE(wait_for_workers(1));
  when_sent(2, [&] {
    draining.change([](msg::WorkerStatus& status) { status.draining(true); });
    // A task may be on its way while the pool already knows that the worker drains.
    when([&] { return pool_->workers() == 0 && held.size() == 2; },
         [&] {
           for (const msg::MatchTask& task : held) draining.answer(task, solver.solve(task));
         });
  });
  const std::vector<MatchTask> tasks = tasks_on(maps_, 10);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(draining.received, 2);
  EXPECT_EQ(pool_->counts().in_process, 8U);
}

TEST_F(PoolWithStragglersTest, AWorkerThatSleptIsTakenBack) {
  set_longest_freeze(0);
  publish_maps();
  Program& sleeper = start_worker("sleeper");
  ASSERT_TRUE(wait_for_workers(1));
  // On a busy machine the worker may miss its time before, and this process does the rest of the
  // batch; then there is another one.
  std::uint64_t sent_before = 0;
  std::optional<std::uint64_t> here_before;
  when([&] { return pool_->counts().sent >= sent_before + 50 && pool_->open_tasks() >= 100; },
       [&] {
         sleeper.send_signal(SIGSTOP);
         here_before = pool_->counts().in_process;
       });
  std::uint64_t first_id = 0;
  ASSERT_TRUE(wait_until("the worker to be stopped with tasks in hand", [&] {
    sent_before = pool_->counts().sent;
    const std::vector<MatchTask> tasks = tasks_on(maps_, 200, first_id);
    expect_same(tasks, pool_->match(tasks));
    first_id += 200;
    return HasFailure() || here_before.has_value();
  }));
  EXPECT_GT(pool_->counts().in_process, here_before.value_or(0));
  EXPECT_THAT(lines_, Contains(HasSubstr("answered elsewhere after")));
  ASSERT_TRUE(wait_until("the stopped worker to be lost", [&] { return pool_->workers() == 0; }));
  sleeper.send_signal(SIGCONT);
  ASSERT_TRUE(wait_until("the worker to be back", [&] { return pool_->workers() == 1; }));
  const std::uint64_t here = pool_->counts().in_process;
  // The worker is used again, but on a busy machine only once its answers come in time.
  std::uint64_t matched = 0;
  ASSERT_TRUE(wait_until("an answer of the worker", [&] {
    const std::vector<MatchTask> more = tasks_on(maps_, 30, first_id + matched);
    expect_same(more, pool_->match(more));
    matched += 30;
    return pool_->counts().in_process < here + matched;
  }));
  EXPECT_EQ(pool_->counts().duplicate_differences, 0U);
  EXPECT_THAT(faults_, IsEmpty());
}

TEST_F(PoolTest, AStopEndsTheWait) {
  FakeWorker hanging(partition_, loop_, "hanging", [](FakeWorker&, const msg::MatchTask&) {});
  ASSERT_TRUE(wait_for_workers(1));
  when_sent(1, [&] { loop_.stop(); });
  EXPECT_THROW(pool_->match(tasks_on(maps_, 3)), localizer::Stopped);
  EXPECT_TRUE(loop_.run_for(hang_limit())) << "the loop around it is to end as well";
}

TEST_F(PoolTest, ATaskThatNobodyCanSolveIsAnError) {
  publish_maps();
  start_worker("w1");
  ASSERT_TRUE(wait_for_workers(1) && wait_for_maps());
  std::vector<MatchTask> tasks = tasks_on(maps_, 3);
  tasks[1].half_width.setZero();
  EXPECT_THROW(pool_->match(tasks), std::invalid_argument);
  EXPECT_THAT(faults_, Contains("task failed"));
  const std::vector<MatchTask> good = tasks_on(maps_, 30, 100);
  expect_same(good, pool_->match(good));
}

}  // namespace
}  // namespace topogeo::test
