// The results of a run equal those of one process, and no task is lost, under all faults and wrong
// answers of its workers.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pool_faults_fixture.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

/// So many tasks show that a worker is used. On a busy machine workers miss their time, and the
/// localizer does most tasks itself; the share that workers do therefore proves nothing.
constexpr std::uint64_t kUsed = 10;

/// Enough for every worker to get a task.
constexpr std::size_t kFewStops = 6;

class PoolFaultsTest : public testing::Test {
 protected:
  /// Starts up to 3 workers and waits until the localizer can use them.
  std::vector<Program*> start_workers(ServiceRun& run, std::size_t count) {
    std::vector<Program*> workers;
    for (const char* name : {"w1", "w2", "w3"}) {
      if (workers.size() < count) workers.push_back(&run.start_worker(name));
    }
    EXPECT_TRUE(run.wait_for_workers(count)) << run.log();
    return workers;
  }
  std::unique_ptr<Program> start_faulty(const ServiceRun& run, const std::string& fault) {
    std::vector<std::string> words = run.flags();
    words.insert(words.end(), {"--fault", fault});
    return std::make_unique<Program>(scratch_, "../tests/faulty_worker", words);
  }
  /// Kills workers that have tasks in hand: they get some while they are stopped. The localizer
  /// notices before the middleware does. If a busy machine gave them no tasks, or the localizer no
  /// time, others take their places and are killed in turn.
  static void kill_with_tasks_in_hand(ServiceRun& run, std::vector<Program*> workers) {
    const auto all = static_cast<std::size_t>(run.counter("workers"));
    Wait wait("workers that are missed before their lease ends, with tasks in hand");
    while (true) {
      ASSERT_TRUE(run.wait_until([&] { return run.connected_workers() >= all; }));
      for (const Program* worker : workers) worker->send_signal(SIGSTOP);
      const auto end = std::chrono::steady_clock::now() + milliseconds(40);
      while (std::chrono::steady_clock::now() < end) run.step();
      for (const Program* worker : workers) worker->send_signal(SIGKILL);
      ASSERT_TRUE(run.wait_for_workers(all - workers.size()));
      const bool before_middleware = run.connected_workers() >= all;
      if (before_middleware && run.counter("workers_lost") > 0.0) return;  // with tasks in hand
      ASSERT_TRUE(wait.goes_on()) << run.log();
      for (Program*& worker : workers) worker = &run.start_worker("next");
      ASSERT_TRUE(run.wait_for_workers(all));
    }
  }
  /// Lets a worker with the fault join for some stops and then ends it. `found_out`: whether the
  /// localizer has noticed.
  void join_with_fault(ServiceRun& run, const std::string& fault,
                       const std::function<bool(const std::string& worker)>& found_out) {
    SCOPED_TRACE(fault);
    const std::unique_ptr<Program> worker = start_faulty(run, fault);
    const std::string id = fault + "#" + std::to_string(worker->pid());
    // Checks the log, because the worker may be found out before a status has counted it.
    EXPECT_TRUE(run.wait_until([&] {
      return run.log().find("worker " + id + " joined") != std::string::npos;
    })) << worker->err();
    EXPECT_TRUE(run.go_on_until_stop(run.stops() + kFewStops));
    EXPECT_TRUE(run.wait_until([&] { return found_out("worker " + id); })) << run.log();
    EXPECT_FALSE(run.has_ended());
    worker->send_signal(SIGTERM);
    EXPECT_EQ(worker->wait(), 0) << worker->err();
    EXPECT_TRUE(run.wait_for_workers(1));
  }
  /// Expects a fault that names the worker (empty: of any reason), and no more tasks for it.
  void expect_excluded(ServiceRun& run, const std::string& fault,
                       const std::string& reason = "wrong match result") {
    // A reason is logged once per second.
    constexpr milliseconds kLogPeriod{1100};
    const auto start = std::chrono::steady_clock::now();
    run.wait_until([&] { return std::chrono::steady_clock::now() - start > kLogPeriod; });
    const double excluded = run.counter("workers_excluded");
    join_with_fault(run, fault, [&](const std::string& worker) {
      return run.counter("workers_excluded") == excluded + 1.0 && run.counter("workers") == 1.0 &&
             run.log().find(reason + ": " + worker) != std::string::npos;
    });
    EXPECT_TRUE(reason.empty() || run.faults(reason) > 0);
  }
  /// Expects that the worker is reported as stalled, and gets no tasks for a while.
  void expect_passed_over(ServiceRun& run, const std::string& fault) {
    join_with_fault(run, fault, [&](const std::string& worker) {
      return run.log().find(worker + " stalled with") != std::string::npos;
    });
  }
  /// Tasks that each of these workers has done when the localizer has no work left.
  static std::vector<std::uint64_t> tasks_done(ServiceRun& run,
                                               const std::vector<Program*>& workers) {
    EXPECT_TRUE(run.wait_until_idle()) << run.log();
    std::vector<std::uint64_t> done;
    for (const Program* worker : workers) {
      // The next status may have been under way already.
      for (int i = 0; i < 2; ++i) {
        const double last_s = run.uptime_s(*worker);
        EXPECT_TRUE(run.wait_until([&] { return run.uptime_s(*worker) > last_s; }));
      }
      done.push_back(run.tasks_done(*worker));
    }
    return done;
  }
  /// Expects that each of these workers has been used since it had done so many tasks.
  static void expect_used(ServiceRun& run, const std::vector<Program*>& workers,
                          const std::vector<std::uint64_t>& before) {
    for (std::size_t i = 0; i < workers.size(); ++i) {
      EXPECT_TRUE(run.wait_until([&] {
        return run.tasks_done(*workers[i]) >= before.at(i) + kUsed;
      })) << "worker "
          << i << " of those that are left has done " << run.tasks_done(*workers[i]) - before.at(i)
          << " tasks";
    }
  }

  // A killed program leaves segments in /dev/shm, which would fill that of a container.
  const bool udp_only_ = (use_udp_only(), true);
  Scratch scratch_;
  Drive drive_{scratch_};
};

TEST_F(PoolFaultsTest, OneOfThreeWorkersIsKilled) {
  ServiceRun run(scratch_, drive_, "run");
  const std::vector<Program*> workers = start_workers(run, 3);
  ASSERT_TRUE(run.go_on_until_stop(15));
  kill_with_tasks_in_hand(run, {workers[0]});
  const std::vector<Program*> left{workers[1], workers[2]};
  const std::vector<std::uint64_t> before = tasks_done(run, left);
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  run.report_recovery();
  EXPECT_TRUE(run.wait_for_workers(2));
  expect_used(run, left, before);
}

TEST_F(PoolFaultsTest, AllWorkersAreKilledAndOthersCome) {
  ServiceRun run(scratch_, drive_, "run");
  const std::vector<Program*> workers = start_workers(run, 2);
  ASSERT_TRUE(run.go_on_until_stop(15));
  kill_with_tasks_in_hand(run, workers);
  ASSERT_TRUE(run.go_on_until_stop(run.stops() + 20));
  ASSERT_TRUE(run.wait_until_idle());
  ASSERT_TRUE(run.wait_for_workers(0));
  const double in_process = run.counter("tasks_in_process");
  EXPECT_GT(in_process, 0.0);

  const std::vector<Program*> late{&run.start_worker("late1"), &run.start_worker("late2")};
  ASSERT_TRUE(run.wait_for_workers(2));
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  run.report_recovery();
  expect_used(run, late, {0, 0});
}

TEST_F(PoolFaultsTest, AWorkerStandsStillUntilItIsTakenToBeGone) {
  set_longest_freeze(0);
  ServiceRun run(scratch_, drive_, "run");
  const std::vector<Program*> workers = start_workers(run, 2);
  ASSERT_TRUE(run.go_on_until_stop(20));
  workers[0]->send_signal(SIGSTOP);
  ASSERT_TRUE(run.go_on_until_stop(run.stops() + 20));
  ASSERT_TRUE(run.wait_for_workers(1));
  workers[0]->send_signal(SIGCONT);
  ASSERT_TRUE(run.wait_for_workers(2)) << run.log();
  const std::uint64_t done = run.tasks_done(*workers[0]);
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  run.report_recovery();
  EXPECT_EQ(run.counter("duplicate_differences"), 0.0);
  // More than it had in hand.
  EXPECT_TRUE(run.wait_until([&] { return run.tasks_done(*workers[0]) > done + 2; }));
}

TEST_F(PoolFaultsTest, WorkersAnswerMalformedResults) {
  ServiceRun run(scratch_, drive_, "run");
  start_workers(run, 1);
  ASSERT_TRUE(run.go_on_until_stop(5));
  expect_excluded(run, "not_a_number");
  expect_excluded(run, "many_solutions");
  expect_excluded(run, "garbage");
  // These answers name no task.
  expect_passed_over(run, "unknown_task");
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  run.report_recovery();
}

TEST_F(PoolFaultsTest, WorkersAnswerWrongOrPoorResults) {
  ServiceRun run(scratch_, drive_, "run");
  start_workers(run, 1);
  ASSERT_TRUE(run.go_on_until_stop(5));
  expect_excluded(run, "shifted");
  expect_excluded(run, "embellished");
  expect_excluded(run, "poorer", "");  // or as good, but not what the task asks for
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  run.report_recovery();
}

TEST_F(PoolFaultsTest, WorkersHaveTheSameNameOrId) {
  ServiceRun run(scratch_, drive_, "run");
  const Program& one = run.start_worker("twin");
  const Program& other = run.start_worker("twin");
  ASSERT_TRUE(run.wait_for_workers(2)) << "a name is not an id";
  const std::unique_ptr<Program> copy = start_faulty(run, "copied_worker_id");
  ASSERT_TRUE(run.wait_until([&] { return run.counter("workers_of_one_id") == 1.0; }));
  // On a busy machine one of the two may be taken to be gone for a moment.
  EXPECT_TRUE(run.wait_for_workers(2)) << "the copy is no third worker";
  EXPECT_TRUE(run.go_on_until([&] { return run.counter("answers_ignored") > 0.0; }))
      << "the copy has not answered";
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  EXPECT_EQ(run.faults("two workers of one id"), 1U);
  EXPECT_EQ(run.counter("workers_excluded"), 0.0) << "its answers were taken for the other's";
  EXPECT_TRUE(run.wait_until([&] { return run.tasks_done(one) > 0 && run.tasks_done(other) > 0; }));
}

TEST_F(PoolFaultsTest, TwoRobotsOfOneNameShareTheWorkers) {
  ServiceRun first(scratch_, drive_, "first");
  ServiceRun second(scratch_, drive_, "second");
  // Started by hand, it serves every run on the domain.
  const Program one(scratch_, "ga_worker", {"--domain", own_domain()});
  const Program other(scratch_, "ga_worker", {"--domain", own_domain()});
  ASSERT_TRUE(first.wait_for_workers(2) && second.wait_for_workers(2));
  const auto step = [&] {
    first.step();
    second.step();
  };
  // A robot whose tasks the workers leave for those of the other one does them itself.
  const auto shared = static_cast<double>(kUsed);
  const auto by_workers = [](const ServiceRun& run) {
    return run.counter("tasks") - run.counter("tasks_in_process");
  };
  ASSERT_TRUE(wait_for(
      "tasks of two robots that workers do",
      [&] { return std::min(by_workers(first), by_workers(second)) >= shared; }, step))
      << first.log() << second.log();
  EXPECT_LT(std::max(first.stops(), second.stops()), drive_.stops_of(drive_.scans().size()))
      << "a robot is served only after the other one";
  std::cout << "tasks by workers while both ran: " << by_workers(first) << " and "
            << by_workers(second) << '\n';
  ASSERT_TRUE(first.finish() && second.finish());
  first.expect_same_results();
  second.expect_same_results();
}

TEST_F(PoolFaultsTest, WorkersOfOtherBuildsAreRefused) {
  ServiceRun run(scratch_, drive_, "run");
  const std::string config = scratch_ / "other.yaml";
  std::ofstream(config) << "localizer:\n  seed: 2\n";
  std::vector<std::string> words = run.flags();
  words.insert(words.end(), {"--config", config});
  const Program other_configuration(scratch_, "ga_worker", words);
  const std::unique_ptr<Program> other_version = start_faulty(run, "other_version");
  const std::unique_ptr<Program> other_matcher = start_faulty(run, "other_matcher");
  EXPECT_TRUE(run.wait_until([&] {
    return run.counter("workers_of_other_configuration") == 1.0 &&
           run.counter("workers_of_other_version") == 1.0 &&
           run.counter("workers_of_other_matcher") == 1.0;
  }));
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  EXPECT_EQ(run.faults("worker of another configuration"), 1U);
  EXPECT_EQ(run.faults("worker of another version"), 1U);
  EXPECT_EQ(run.faults("worker computes differently"), 1U);
  EXPECT_THAT(run.log(), HasSubstr("version 0.0.0-other, here "));
  EXPECT_EQ(run.counter("tasks_sent"), 0.0);
  EXPECT_EQ(run.counter("tasks_in_process"), run.counter("tasks"));
}

TEST_F(PoolFaultsTest, AWorkerLeavesInOrder) {
  ServiceRun run(scratch_, drive_, "run");
  const std::vector<Program*> workers = start_workers(run, 2);
  ASSERT_TRUE(run.go_on_until_stop(30));
  workers[0]->send_signal(SIGTERM);
  ASSERT_TRUE(run.go_on_until_stop(run.stops() + 20));
  EXPECT_EQ(workers[0]->wait(), 0) << workers[0]->err();
  const std::vector<Program*> left{workers[1]};
  const std::vector<std::uint64_t> before = tasks_done(run, left);
  ASSERT_TRUE(run.finish()) << run.log();
  run.expect_same_results();
  EXPECT_THAT(workers[0]->err(), Not(HasSubstr("not finished")));
  expect_used(run, left, before);
  // On a busy machine, workers miss their time or are taken to be gone: their tasks are sent again.
  if (run.log().find("answered elsewhere") == std::string::npos) {
    EXPECT_THAT(run.log(), Not(ContainsRegex("worker w1#[0-9a-f]+ lost with")));
    EXPECT_EQ(run.counter("workers_lost"), 0.0) << run.log();
    EXPECT_EQ(run.counter("tasks_resent"), 0.0) << run.log();
  }
}

}  // namespace
}  // namespace topogeo::test
