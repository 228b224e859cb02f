// Workers that cannot be trusted: of another build, wrong, worse, or two under one id.
#include <limits>
#include <optional>
#include <utility>

#include "pool_fixture.hpp"

namespace topogeo::test {
namespace {

using localization::MatchResult;
using localization::MatchTask;
using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A short search often ends at the pose of a long one, but with another answer.
const ::testing::Matcher<std::string> kWorse =
    ::testing::AnyOf("poorer match result", "different answers to a task");

class PoolTrustTest : public PoolTest {
 protected:
  /// A worker that solves every task correctly.
  FakeWorker::OnTask honest() {
    return [this](FakeWorker& self, const msg::MatchTask& task) {
      self.answer(task, solver_.solve(task));
    };
  }
  /// Expects that the pool refuses a worker with this status and sends it no task.
  void expect_refused(const FakeWorker::Dress& dress, const std::string& reason,
                      const std::string& detail) {
    FakeWorker other(partition_, loop_, "other", honest(), dress);
    ASSERT_TRUE(wait_until("a fault", [&] { return !faults_.empty(); }));
    const std::vector<MatchTask> tasks = tasks_on(maps_, 10);
    expect_same(tasks, pool_->match(tasks));
    // The worker announces itself again, and the pool reads it before this loop does.
    const std::uint64_t seen = announced_;
    ASSERT_TRUE(
        wait_until("further statuses of the worker", [&] { return announced_ >= seen + 3; }));
    EXPECT_EQ(pool_->counts().sent, 0U);
    EXPECT_EQ(other.received, 0);
    EXPECT_EQ(pool_->workers(), 0U);
    EXPECT_THAT(faults_, ElementsAre(reason)) << "once";
    EXPECT_THAT(details_[0], HasSubstr("worker other on host here: " + detail));
  }
  /// Expects that the pool excludes a worker with these answers, next to an honest one.
  void expect_excluded(const FakeWorker::OnTask& on_task,
                       const ::testing::Matcher<std::string>& reason, const std::string& detail) {
    FakeWorker liar(partition_, loop_, "liar", on_task);
    FakeWorker good(partition_, loop_, "good", honest());
    ASSERT_TRUE(wait_for_workers(2));
    const std::vector<MatchTask> tasks = tasks_on(maps_, 40);
    expect_same(tasks, pool_->match(tasks));
    EXPECT_THAT(faults_, ElementsAre(reason)) << "once";
    EXPECT_THAT(details_[0], HasSubstr("worker liar on host here, task "));
    EXPECT_THAT(details_[0], HasSubstr(detail));
    EXPECT_EQ(pool_->workers(), 1U);
    EXPECT_EQ(pool_->counts().workers_excluded, 1U);
    EXPECT_EQ(pool_->counts().in_process, 0U) << "the other one did it all";
    const int received = liar.received;
    const std::vector<MatchTask> more = tasks_on(maps_, 10, 1000);
    expect_same(more, pool_->match(more));
    EXPECT_EQ(liar.received, received);
    EXPECT_EQ(faults_.size(), 1U);
  }
  static std::uint64_t received_by(const FakeWorker& worker) {
    return static_cast<std::uint64_t>(worker.received);
  }

  Solver solver_{maps_};
  std::uint64_t announced_ = 0;  // number of workers' statuses

 private:
  void SetUp() override {
    PoolTest::SetUp();
    loop_.add<msg::WorkerStatus>(statuses_, [this](const auto&, const auto&) { ++announced_; });
  }

  messaging::Reader<msg::WorkerStatus> statuses_{participant_};
};

TEST_F(PoolTrustTest, AnotherVersionIsRefusedBeforeAnyTask) {
  expect_refused([](msg::WorkerStatus& s) { messaging::set_text(s.version(), "0.0.1", "version"); },
                 "worker of another version",
                 "version 0.0.1, here " + std::string(support::kVersion));
  EXPECT_EQ(pool_->registry_counts().other_version, 1U);
}

TEST_F(PoolTrustTest, AnotherMatcherIsRefusedBeforeAnyTask) {
  expect_refused([](msg::WorkerStatus& s) { s.matcher_fingerprint(0xabc); },
                 "worker computes differently", "matcher fingerprint 0000000000000abc, here ");
  EXPECT_EQ(pool_->registry_counts().other_matcher, 1U);
}

TEST_F(PoolTrustTest, AnotherConfigurationIsRefusedBeforeAnyTask) {
  expect_refused([](msg::WorkerStatus& s) { s.config_fingerprint(0x13); },
                 "worker of another configuration",
                 "configuration fingerprint 0000000000000013, here 0000000000000012");
  EXPECT_EQ(pool_->registry_counts().other_configuration, 1U);
}

TEST_F(PoolTrustTest, TheSameConfigurationIsNotRefused) {
  FakeWorker same(partition_, loop_, "same", honest(),
                  [](msg::WorkerStatus& s) { s.config_fingerprint(0x12); });
  ASSERT_TRUE(wait_for_workers(1));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 10);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_EQ(same.received, 10);
  EXPECT_EQ(pool_->counts().audits, 3U) << "as many as a new worker has to stand";
  EXPECT_THAT(faults_, IsEmpty());
}

TEST_F(PoolTrustTest, AWorkerThatRefusesIsNotAskedAgain) {
  for (const auto& [status, reason] :
       {std::pair{msg::kMatchOtherVersion, "worker of another version"},
        std::pair{msg::kMatchOtherConfiguration, "worker of another configuration"}}) {
    faults_.clear();
    FakeWorker refusing(partition_, loop_, reason,
                        [status = status](FakeWorker& self, const msg::MatchTask& task) {
                          self.answer(task, {}, status);
                        });
    ASSERT_TRUE(wait_for_workers(1));
    const std::vector<MatchTask> tasks = tasks_on(maps_, 30, 1000 * std::uint64_t{status});
    expect_same(tasks, pool_->match(tasks));
    EXPECT_LE(refusing.received, 2);
    EXPECT_THAT(faults_, ElementsAre(reason));
    EXPECT_EQ(pool_->workers(), 0U);
  }
}

TEST_F(PoolTrustTest, AWrongAnswerIsRefused) {
  expect_excluded(
      [this](FakeWorker& self, const msg::MatchTask& task) {
        MatchResult result = solver_.solve(task);
        if (self.received > 1) result.fitness += 1e-9;  // the first answer is right
        self.answer(task, result);
      },
      "wrong match result", "the fitness");
}

TEST_F(PoolTrustTest, AnAnswerWithoutASearchIsRefused) {
  expect_excluded(
      [this](FakeWorker& self, const msg::MatchTask& task) {
        MatchResult result = solver_.solve(task);
        result.evaluations = 0;
        self.answer(task, result);
      },
      "wrong match result", "0 evaluations");
}

TEST_F(PoolTrustTest, AMalformedAnswerIsRefused) {
  expect_excluded(
      [this](FakeWorker& self, const msg::MatchTask& task) {
        MatchResult result = solver_.solve(task);
        result.overlap = std::numeric_limits<double>::quiet_NaN();
        self.answer(task, result);
      },
      "wrong match result", "overlap");
}

TEST_F(PoolTrustTest, AnAnswerOfAnotherSchemaIsRefused) {
  // A writer without the library's checks.
  messaging::TopicInfo unchecked = messaging::TopicTraits<msg::MatchResults>::info();
  unchecked.find_defect = [](const void*) { return std::optional<std::string>(); };
  std::optional<messaging::detail::WriterCore> writer;
  FakeWorker::OnTask on_task = [&](FakeWorker& self, const msg::MatchTask& task) {
    if (!writer) writer.emplace(self.participant(), unchecked, "");
    ASSERT_TRUE(wait_by("a reader of results",
                        [&](auto at_most) { return writer->wait_for_matched(1, at_most); }));
    msg::MatchResults result;
    result.schema_version(1);
    messaging::set_client_id(result, self.client_id());
    messaging::set_worker_id(result, "old");
    result.results().resize(1);
    result.results().front().task_id(task.task_id());
    ASSERT_TRUE(writer->write(&result));
  };
  FakeWorker old(partition_, loop_, "old", on_task);
  FakeWorker good(partition_, loop_, "good", honest());
  ASSERT_TRUE(wait_for_workers(2));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 40);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_THAT(faults_, ElementsAre("wrong match result"));
  EXPECT_THAT(details_[0], HasSubstr("worker old on host here: "));
  EXPECT_THAT(details_[0], HasSubstr("schema"));
  EXPECT_EQ(pool_->workers(), 1U);
}

TEST_F(PoolTrustTest, AnAnswerWithAnotherSeedIsRefused) {
  expect_excluded(
      [this](FakeWorker& self, const msg::MatchTask& task) {
        MatchResult result = solver_.solve(task);
        result.seed += 1;
        self.answer(task, result);
      },
      "wrong match result", "seed");
}

TEST_F(PoolTrustTest, APoorerAnswerIsFoundByComparing) {
  expect_excluded(
      [this](FakeWorker& self, const msg::MatchTask& task) {
        self.answer(task, solver_.solve_poorly(task));
      },
      kWorse, "here");
  EXPECT_EQ(pool_->counts().audit_differences, 1U);
}

class PoolAuditTest : public PoolTrustTest {
 protected:
  PoolAuditTest() { board_options_.audit_every = 4; }
};

TEST_F(PoolAuditTest, AWorkerThatBecomesLazyLaterIsFoundAndItsAnswersAreDoneAgain) {
  expect_excluded(
      [this](FakeWorker& self, const msg::MatchTask& task) {
        self.answer(task, self.received <= 3 ? solver_.solve(task) : solver_.solve_poorly(task));
      },
      kWorse, "here");
  EXPECT_GE(pool_->counts().audits, 4U);
}

/// Answers are compared only when two workers give them.
class PoolDuplicatesTest : public PoolTrustTest {
 protected:
  PoolDuplicatesTest() { board_options_.audit_every = 0; }
};

/// A task is done in this process though a worker has it. The worker gets no other task instead,
/// however long this process takes.
class PoolStragglerTest : public PoolDuplicatesTest {
 protected:
  PoolStragglerTest() {
    board_options_.straggler_floor = milliseconds(300);
    board_options_.forget_after = board_options_.longest_forget_after = hang_limit();
  }
};

TEST_F(PoolStragglerTest, LateAnswersAreCompared) {
  std::vector<msg::MatchTask> held;
  FakeWorker hanging(partition_, loop_, "hanging",
                     [&](FakeWorker&, const msg::MatchTask& task) { held.push_back(task); });
  ASSERT_TRUE(wait_for_workers(1));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  ASSERT_EQ(held.size(), 2U);
  hanging.answer(held[0], solver_.solve(held[0]));
  ASSERT_TRUE(wait_until("one late answer", [&] { return pool_->counts().duplicates == 1; }));
  EXPECT_THAT(faults_, IsEmpty());
  hanging.answer(held[1], solver_.solve_poorly(held[1]));
  ASSERT_TRUE(wait_until("two late answers", [&] { return pool_->counts().duplicates == 2; }));
  EXPECT_EQ(pool_->counts().duplicate_differences, 1U);
  EXPECT_THAT(faults_, ElementsAre(kWorse));
  EXPECT_EQ(pool_->workers(), 0U) << "it is excluded";
}

// The first three answers of the fast worker are always compared, and honest, so that only the
// duplicate reveals it. The slow worker then leaves with its tasks in hand, which go to the fast
// one, and still answers them.
TEST_F(PoolDuplicatesTest, WhenTwoWorkersDifferTheOneThatErredGoes) {
  std::vector<msg::MatchTask> held;
  bool left = false;
  bool erred = false;
  std::optional<FakeWorker> slow;
  const auto leave = [&](const FakeWorker& fast) {
    if (left || held.empty() || fast.received < 4) return;
    left = true;
    slow->leave();
  };
  FakeWorker fast(partition_, loop_, "fast", [&](FakeWorker& self, const msg::MatchTask& task) {
    const bool again = std::ranges::any_of(
        held, [&](const msg::MatchTask& other) { return other.task_id() == task.task_id(); });
    if (!again || erred) {
      self.answer(task, solver_.solve(task));
      leave(self);
      return;
    }
    erred = true;
    self.answer(task, solver_.solve_poorly(task));
    for (const msg::MatchTask& other : held) slow->answer(other, solver_.solve(other));
  });
  slow.emplace(partition_, loop_, "slow", [&](FakeWorker&, const msg::MatchTask& task) {
    held.push_back(task);
    leave(fast);
  });
  ASSERT_TRUE(wait_for_workers(2));
  const std::vector<MatchTask> tasks = tasks_on(maps_, 40);
  expect_same(tasks, pool_->match(tasks));
  EXPECT_TRUE(erred);
  ASSERT_THAT(faults_, ElementsAre(kWorse));
  EXPECT_THAT(details_[0], HasSubstr("worker fast"));
  EXPECT_EQ(pool_->counts().duplicate_differences, 1U);
}

TEST_F(PoolTrustTest, OfTwoProcessesWithOneIdOnlyTheFirstCounts) {
  FakeWorker first(partition_, loop_, "twin", honest());
  ASSERT_TRUE(wait_for_workers(1));
  bool lies = true;
  FakeWorker second(partition_, loop_, "twin", [&](FakeWorker& self, const msg::MatchTask& task) {
    MatchResult result = solver_.solve(task);
    if (lies) result.fitness = 1.0;
    self.answer(task, result);
  });
  ASSERT_TRUE(wait_until("the second of one id to be reported", [&] { return !faults_.empty(); }));
  // When its status has arrived, tasks may not reach it yet.
  std::uint64_t sent = 0;
  ASSERT_TRUE(wait_until("a task to get to the second", [&] {
    pool_->match(tasks_on(maps_, 1, 2000 + sent++));
    return second.received > 0;
  }));
  ASSERT_TRUE(wait_until("the answers of the second to be ignored",
                         [&] { return pool_->counts().ignored == received_by(second); }));
  // An earlier answer may still be on its way.
  const std::uint64_t received_before = received_by(second);
  const std::vector<MatchTask> tasks = tasks_on(maps_, 30);
  expect_same(tasks, pool_->match(tasks));
  sent += 30;
  ASSERT_TRUE(wait_until("the answers of the second to be ignored", [&] {
    return received_by(second) >= received_before + 30 &&
           pool_->counts().ignored == received_by(second);
  }));
  const std::uint64_t received = received_by(second);
  EXPECT_THAT(faults_, ElementsAre("two workers of one id"));
  EXPECT_EQ(pool_->workers(), 1U);
  EXPECT_EQ(pool_->counts().in_process, 0U);
  EXPECT_EQ(received_by(first), sent);
  EXPECT_GE(received, received_before + 30) << "both receive what goes to the id";
  EXPECT_LE(received, sent);
  EXPECT_EQ(pool_->counts().ignored, received);

  lies = false;
  // The second stays silent until the first is gone and its own last statuses have arrived.
  second.cease_to_announce();
  const std::uint64_t seen = announced_;
  ASSERT_TRUE(wait_until("statuses of the first", [&] { return announced_ >= seen + 3; }));
  first.leave();
  ASSERT_TRUE(wait_until("the first to be gone", [&] { return pool_->workers() == 0; }));
  second.begin_to_announce();
  ASSERT_TRUE(wait_until("the second to take over", [&] { return pool_->workers() == 1; }))
      << "the other takes over";
  const std::vector<MatchTask> more = tasks_on(maps_, 10, 1000);
  expect_same(more, pool_->match(more));
  EXPECT_EQ(pool_->counts().in_process, 0U);
  ASSERT_TRUE(wait_until("the answers of the first to be ignored", [&] {
    return received_by(first) == sent + 10 && pool_->counts().ignored >= received + 10;
  })) << "those of the first, which still receives";
  EXPECT_EQ(pool_->counts().ignored, received + 10);
  EXPECT_EQ(faults_.size(), 1U);
}

}  // namespace
}  // namespace topogeo::test
