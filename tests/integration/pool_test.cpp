// The search pool over DDS gives what the search in one process gives, whatever happens to workers.
#include <algorithm>
#include <csignal>

#include "pool_fixture.hpp"

namespace topogeo::test {
namespace {

using localization::MatchResult;
using localization::MatchTask;
using localizer::RemotePool;
using std::chrono::milliseconds;
using ::testing::Contains;
using ::testing::IsEmpty;

class PoolTest : public ::testing::Test {
 protected:
  void SetUp() override {
    localizer::RemotePoolOptions options;
    options.robot_id = "robot";
    options.client_id = "client-" + partition_;
    options.client_id.resize(std::min<std::size_t>(options.client_id.size(), 64));
    options.version = support::kVersion;
    // Nothing is taken from a slow worker on a busy machine, unless a test wants it.
    options.board.straggler_floor = straggler_floor_;
    pool_.emplace(participant_, loop_, options, [this](std::string_view reason, std::string_view) {
      faults_.emplace_back(reason);
    });
    for (const auto& map : maps_) pool_->add_map(map);
  }
  void TearDown() override { workers_.clear(); }

  Program& start_worker(const std::string& id) {
    workers_.push_back(std::make_unique<Program>(
        scratch_, "ga_worker",
        std::vector<std::string>{"--partition", partition_, "--name", id}));
    return *workers_.back();
  }
  void publish_maps() {
    for (const auto& map : maps_) ASSERT_TRUE(map_writer_.write(service::to_msg(*map)));
  }
  void expect_same(const std::vector<MatchTask>& tasks, const std::vector<MatchResult>& results) {
    localization::InProcessPool in_process;
    for (const auto& map : maps_) in_process.add_map(map);
    const std::vector<MatchResult> expected = in_process.match(tasks);
    ASSERT_EQ(results.size(), expected.size());
    std::size_t solved = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_TRUE(localizer::identical(results[i], expected[i])) << "task " << i;
      if (expected[i].status == localization::MatchStatus::kSolved) ++solved;
    }
    EXPECT_GT(solved, expected.size() / 2) << "the tasks are not worth comparing";
  }
  /// Does something once so many tasks are sent, while match() runs.
  void when_sent(std::uint64_t count, std::function<void()> action) {
    timer_ = loop_.add_timer(milliseconds(1), [this, count, action = std::move(action)] {
      if (pool_->counts().sent < count) return;
      loop_.cancel_timer(timer_);
      action();
    });
  }

  std::string partition_ = random_partition();
  Scratch scratch_;
  Maps maps_ = maps_of_room();
  messaging::Participant participant_{options_in(partition_)};
  messaging::Writer<msg::LocalMap> map_writer_{participant_};
  messaging::EventLoop loop_;
  std::chrono::nanoseconds straggler_floor_ = kPatience;
  std::vector<std::string> faults_;
  std::optional<RemotePool> pool_;
  std::vector<std::unique_ptr<Program>> workers_;
  std::uint64_t timer_ = 0;
};

class PoolWithStragglersTest : public PoolTest {
 protected:
  PoolWithStragglersTest() { straggler_floor_ = milliseconds(300); }
};

TEST_F(PoolTest, TwoWorkersGiveWhatOneProcessGives) {
  publish_maps();
  start_worker("w1");
  start_worker("w2");
  ASSERT_EQ(pool_->wait_for_workers(2, kPatience), 2U);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 60);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().sent, 60U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
  EXPECT_THAT(faults_, IsEmpty());
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
  ASSERT_EQ(pool_->wait_for_workers(2, kPatience), 2U);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 400);
  when_sent(100, [&] { killed.send_signal(SIGKILL); });
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().workers_lost, 1U);
  EXPECT_GE(pool_->counts().resent, 1U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
  EXPECT_EQ(pool_->workers(), 1U);
}

TEST_F(PoolTest, WhenTheLastWorkerIsKilledItSearchesItself) {
  publish_maps();
  Program& killed = start_worker("w1");
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
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
  ASSERT_EQ(pool_->wait_for_workers(2, kPatience), 2U);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 400);
  when_sent(100, [&] { stopped.send_signal(SIGTERM); });
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(stopped.wait(), 0);
  EXPECT_EQ(pool_->counts().in_process, 0U);
}

TEST_F(PoolTest, ALateWorkerGetsTheTasksThatAnotherHasNoRoomFor) {
  publish_maps();
  FakeWorker hanging(partition_, loop_, "hanging", [](FakeWorker&, const msg::MatchTask&) {});
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  when_sent(2, [&] {
    start_worker("late");
    when_sent(40, [&] { hanging.leave(); });
  });
  const std::vector<MatchTask> tasks = tasks_on(maps_, 40);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(hanging.received, 2);
  EXPECT_EQ(pool_->counts().sent, 42U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
}

TEST_F(PoolTest, TasksWaitForMapsThatComeLate) {
  start_worker("w1");
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  when_sent(1, [&] { publish_maps(); });
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(pool_->counts().map_missing, 0U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
}

TEST_F(PoolTest, MapsThatNeverComeMakeItSearchItself) {
  start_worker("w1");
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_GE(pool_->counts().map_missing, 1U);
  EXPECT_EQ(pool_->counts().in_process, 30U);
}

TEST_F(PoolTest, AWorkerOfAnotherVersionIsReportedOnceAndNotUsed) {
  FakeWorker other(partition_, loop_, "other", [](FakeWorker& self, const msg::MatchTask& task) {
    self.answer(task, {}, msg::kMatchOtherVersion);
  });
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  expect_same(tasks_on(maps_, 5, 100), pool_->match(tasks_on(maps_, 5, 100)));
  EXPECT_LE(other.received, 2);
  EXPECT_THAT(faults_, ::testing::ElementsAre("worker of another version"));
  EXPECT_EQ(pool_->workers(), 0U);
}

TEST_F(PoolWithStragglersTest, AHangingWorkerHoldsNothingUpAndADifferentAnswerIsReported) {
  std::vector<msg::MatchTask> held;
  FakeWorker hanging(partition_, loop_, "hanging",
                     [&](FakeWorker&, const msg::MatchTask& task) { held.push_back(task); });
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  const std::vector<MatchResult> results = pool_->match(tasks);
  expect_same(tasks, results);
  EXPECT_EQ(pool_->counts().in_process, 30U);
  ASSERT_EQ(held.size(), 2U);
  hanging.answer(held[0], results[0]);
  MatchResult other = results[1];
  other.overlap += 1e-9;
  hanging.answer(held[1], other);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (pool_->counts().duplicates < 2 && std::chrono::steady_clock::now() < end) {
    loop_.run_for(milliseconds(5));
  }
  EXPECT_EQ(pool_->counts().duplicates, 2U);
  EXPECT_EQ(pool_->counts().duplicate_differences, 1U);
  EXPECT_THAT(faults_, Contains("different answers to a task"));
}

TEST_F(PoolTest, AStopEndsTheWait) {
  FakeWorker hanging(partition_, loop_, "hanging", [](FakeWorker&, const msg::MatchTask&) {});
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  when_sent(1, [&] { loop_.stop(); });
  EXPECT_THROW(pool_->match(tasks_on(maps_, 3)), localizer::Stopped);
  EXPECT_TRUE(loop_.run_for(kPatience)) << "the loop around it is to end as well";
}

TEST_F(PoolTest, ATaskThatNobodyCanSolveIsAnError) {
  publish_maps();
  start_worker("w1");
  ASSERT_EQ(pool_->wait_for_workers(1, kPatience), 1U);
  std::vector<MatchTask> tasks = tasks_on(maps_, 3);
  tasks[1].half_width.setZero();
  EXPECT_THROW(pool_->match(tasks), std::invalid_argument);
  EXPECT_THAT(faults_, Contains("task failed"));
  const std::vector<MatchTask> good = tasks_on(maps_, 30, 100);
  expect_same(good, pool_->match(good));
}

}  // namespace
}  // namespace topogeo::test
