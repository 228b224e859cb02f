#include "topogeo/supervision/process_group.hpp"

#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <unistd.h>

#include "waiting.hpp"

namespace topogeo::supervision {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const ProcessGroup::Pause kSleep = [](std::chrono::milliseconds duration) {
  std::this_thread::sleep_for(duration);  // like a program between two checks
};
const auto kNever = [] { return false; };

class ProcessGroupTest : public testing::Test {
 protected:
  ~ProcessGroupTest() override { std::filesystem::remove_all(logs_); }

  void start(const std::string& name, const std::string& script,
             Importance importance = Importance::kNeeded) {
    group_.start(name, "sh", {"-c", script}, importance);
  }
  /// Runs until it is killed; executes `on_term` when it is asked to end.
  void start_endless(const std::string& name, const std::string& on_term) {
    start(name, "trap '" + on_term + "' TERM; echo ready; while :; do sleep 0.01; done");
    ASSERT_TRUE(test::wait_for(name + " to begin",
                               [&] { return log_of(name).find("ready") != std::string::npos; }));
  }
  [[nodiscard]] std::string log_of(const std::string& name) const {
    std::ifstream file(logs_ / (name + ".log"));
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// Observes the test's processes: time is the group's clock, and `progress_` is their progress.
  [[nodiscard]] EndObserver observer() {
    EndObserver observer;
    observer.now_s = [this] { return hour_s_; };
    observer.progress = [this](pid_t pid) { return progress_[pid]; };
    observer.log = [this](const std::string& line) { lines_.push_back(line); };
    return observer;
  }

  std::filesystem::path logs_ =
      std::filesystem::temp_directory_path() / ("process_group_test_" + std::to_string(::getpid()));
  double hour_s_ = 3600.0;
  std::map<pid_t, Progress> progress_;  // of each process; a missing one hangs
  std::vector<std::string> lines_;
  ProcessGroup group_{"/bin", logs_, observer()};
};

TEST_F(ProcessGroupTest, ReportsOnceHowANeededProcessEnded) {
  start("store", "echo disk full; exit 3");
  group_.wait();
  const std::optional<UnexpectedEnd> end = group_.next_unexpected_end();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->description, "store ended with exit code 3; last line of its log: disk full");
  EXPECT_TRUE(end->fatal);
  EXPECT_FALSE(group_.next_unexpected_end());
}

TEST_F(ProcessGroupTest, KnowsItsProcesses) {
  start("store", "exit 3");
  const pid_t store = group_.pid("store");
  EXPECT_TRUE(group_.has(store));
  EXPECT_FALSE(group_.has(::getpid()));
  group_.wait();
  EXPECT_TRUE(group_.has(store));
}

TEST_F(ProcessGroupTest, TheEndOfAnExpendableProcessIsNotFatal) {
  start("worker", "kill -9 $$", Importance::kExpendable);
  group_.wait();
  const std::optional<UnexpectedEnd> end = group_.next_unexpected_end();
  ASSERT_TRUE(end);
  EXPECT_THAT(end->description, HasSubstr("worker was killed by signal 9"));
  EXPECT_THAT(end->description, HasSubstr("its log is empty"));
  EXPECT_FALSE(end->fatal);
}

TEST_F(ProcessGroupTest, OneThatDiedIsStartedAgainWithoutWhatWasForItsFirstStart) {
  group_.start("store", "sh", {"-c", "echo life $0; kill -9 $$", "first"}, Importance::kNeeded,
               Restart::kWhenItDies);
  group_.leave_out_at_restart("store", "first");
  group_.wait();
  const std::optional<UnexpectedEnd> end = group_.next_unexpected_end();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->name, "store");
  EXPECT_TRUE(end->can_restart);
  group_.restart("store");
  EXPECT_EQ(group_.wait().size(), 1U);
  EXPECT_TRUE(group_.next_unexpected_end());
  EXPECT_EQ(log_of("store"), "life first\n");
  EXPECT_EQ(log_of("store-2"), "life /bin/sh\n");
}

TEST_F(ProcessGroupTest, OneThatIsKilledIsStartedAgainWithAnotherValueOfAnOption) {
  group_.start("gateway", "sh", {"-c", "echo $0 $1 $2; exec sleep 60", "log", "--readers", "2"},
               Importance::kNeeded, Restart::kWhenItDies);
  group_.set_at_restart("gateway", "--readers", "1");
  group_.set_at_restart("gateway", "--rate", "3");  // it has none
  group_.kill("gateway");
  group_.wait();
  EXPECT_TRUE(group_.next_unexpected_end()->can_restart);
  group_.restart("gateway");
  EXPECT_TRUE(test::wait_for("the second gateway to print its options",
                             [&] { return log_of("gateway-2") == "log --readers 1\n"; }));
  group_.kill("gateway");
  group_.wait();
}

TEST_F(ProcessGroupTest, OneThatSaysItCannotWorkIsNotStartedAgain) {
  group_.start("store", "sh", {"-c", "exit 3"}, Importance::kNeeded, Restart::kWhenItDies);
  group_.wait();
  EXPECT_FALSE(group_.next_unexpected_end()->can_restart);
}

TEST_F(ProcessGroupTest, OneThatDiesAgainAndAgainIsGivenUp) {
  group_.start("store", "sh", {"-c", "exit 1"}, Importance::kNeeded, Restart::kWhenItDies);
  std::uint32_t restarts = 0;
  for (;; ++restarts) {
    group_.wait();
    const std::optional<UnexpectedEnd> end = group_.next_unexpected_end();
    ASSERT_TRUE(end);
    if (!end->can_restart) break;
    group_.restart("store");
  }
  EXPECT_EQ(restarts, ProcessGroup::kMostRestarts);
}

TEST_F(ProcessGroupTest, OneThatMayFinishIsReportedOnlyWhenItFails) {
  start("recorder", "exit 0", Importance::kMayFinish);
  group_.wait();
  EXPECT_FALSE(group_.next_unexpected_end());
  start("recorder_2", "exit 1", Importance::kMayFinish);
  group_.wait();
  ASSERT_TRUE(group_.next_unexpected_end());
}

TEST_F(ProcessGroupTest, OneThatIsAskedToFinishMayDoSo) {
  start_endless("gateway", "exit 0");
  group_.finish("gateway");
  group_.wait();
  EXPECT_FALSE(group_.next_unexpected_end());
}

TEST_F(ProcessGroupTest, StopAsksOneFirstAndKillsAllAtOnceWhenItShall) {
  start_endless("stubborn", "");
  start_endless("gateway", "exit 0");
  const auto at_once = [&] { return group_.has_ended("gateway"); };
  EXPECT_THAT(group_.stop(kSleep, at_once, "gateway"), ElementsAre("stubborn"));
  EXPECT_EQ(group_.wait().size(), 2U);
}

TEST_F(ProcessGroupTest, StopWaitsForThoseThatEnd) {
  start_endless("first", "exit 0");
  start_endless("second", "exit 0");
  EXPECT_THAT(group_.stop(kSleep, kNever, "second"), IsEmpty());
  std::vector<std::string> names;
  for (const support::StageTime& time : group_.wait()) names.push_back(time.stage);
  EXPECT_THAT(names, ElementsAre("first", "second")) << "in the order of their start";
}

TEST_F(ProcessGroupTest, ThoseThatRetireAreStartedAnewAndOneGoesOn) {
  start_endless("page", "exit 0");
  start_endless("store", "exit 0");
  start_endless("stubborn", "");
  const pid_t page = group_.pid("page");
  group_.retire("page");
  EXPECT_FALSE(group_.retired()) << "one does not end by itself";
  while (!group_.retired()) hour_s_ += EndWatch::kHangs_s;
  EXPECT_FALSE(group_.next_unexpected_end()) << "they were asked to";
  start("page", "echo other page");
  start("store", "echo other store; exit 3");
  EXPECT_EQ(group_.pid("page"), page);
  EXPECT_TRUE(test::wait_for("the second store to print its line",
                             [&] { return log_of("store-2") == "other store\n"; }));
  std::optional<UnexpectedEnd> end;
  ASSERT_TRUE(test::wait_for("the end of the second store", [&] {
    end = group_.next_unexpected_end();
    return end.has_value();
  }));
  EXPECT_EQ(end->name, "store") << "it is watched again";
  group_.stop(kSleep, kNever);
  EXPECT_EQ(group_.wait().size(), 3U);
}

TEST_F(ProcessGroupTest, OneThatIsSlowIsWaitedForAndOneThatHangsIsKilled) {
  start_endless("slow", "while [ ! -e " + (logs_ / "free").string() + " ]; do :; done; exit 0");
  start_endless("hung", "");
  const pid_t slow = group_.pid("slow");
  const double start_s = hour_s_;
  // In an hour, the slow one alternately works and waits for a CPU.
  const auto pause = [&](std::chrono::milliseconds) {
    hour_s_ += 1.0;
    progress_[slow].ran_s += 0.04;
    progress_[slow].waited_s += 0.2;
    if (hour_s_ - start_s == 3600.0) std::ofstream(logs_ / "free") << "now";
    if (hour_s_ - start_s >= 3600.0) kSleep(std::chrono::milliseconds(1));
  };
  EXPECT_THAT(group_.stop(pause, kNever), ElementsAre("hung"));
  EXPECT_THAT(lines_,
              testing::Contains(HasSubstr(
                  "waits for slow to end: it worked for 0.2 s and waited 1.0 s for a CPU")));
  EXPECT_THAT(lines_, testing::Contains("hung hangs and is killed: no work, no waiting for a CPU "
                                        "and no status for 20 s"));
  EXPECT_EQ(group_.wait().size(), 2U);
}

TEST_F(ProcessGroupTest, OneThatIsToEndByItselfHangsOrDoesNot) {
  start_endless("recorder", "");
  const pid_t recorder = group_.pid("recorder");
  for (int i = 0; i < 100; ++i) {
    ASSERT_FALSE(group_.hangs("recorder")) << i;
    hour_s_ += EndWatch::kHangs_s / 2.0;
    ++progress_[recorder].reports;
  }
  while (!group_.hangs("recorder")) hour_s_ += 1.0;
  EXPECT_FALSE(group_.has_ended("recorder")) << "that is left to the caller";
  group_.kill("recorder");
}

TEST_F(ProcessGroupTest, AProgramThatIsNotThereIsAnError) {
  EXPECT_THROW(group_.start("none", "no_such_program", {}), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::supervision
