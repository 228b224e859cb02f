// Whether a process that was asked to end hangs, or is only slow.
#include "topogeo/supervision/end_watch.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/supervision/child_process.hpp"

#include "waiting.hpp"

namespace topogeo::supervision {
namespace {

using EndVerdict = EndWatch::Verdict;

/// The verdicts of a watch at successive seconds.
template <class ProgressAt>
std::vector<EndVerdict> verdicts(int seconds, const ProgressAt& progress_at) {
  EndWatch watch(progress_at(0), 0.0);
  std::vector<EndVerdict> all;
  for (int second = 1; second <= seconds; ++second) {
    all.push_back(watch.check(progress_at(second), second));
  }
  return all;
}

TEST(EndWatch, OneThatWorksOrWaitsForACpuOrReportsIsWaitedFor) {
  constexpr int kHour_s = 3600;
  const auto works = [](int second) { return Progress{0.02 * second, 0.0, 0}; };
  const auto has_no_cpu = [](int second) { return Progress{0.0, 0.9 * second, 0}; };
  const auto reports = [](int second) {
    return Progress{0.0, 0.0, static_cast<std::uint64_t>(second / 15)};
  };
  const auto writes = [](int second) { return Progress{0.0, 0.0, 0, second % 10 == 0}; };
  EXPECT_THAT(verdicts(kHour_s, works), testing::Not(testing::Contains(EndVerdict::kHangs)));
  EXPECT_THAT(verdicts(kHour_s, has_no_cpu), testing::Not(testing::Contains(EndVerdict::kHangs)));
  EXPECT_THAT(verdicts(kHour_s, reports), testing::Not(testing::Contains(EndVerdict::kHangs)));
  EXPECT_THAT(verdicts(kHour_s, writes), testing::Not(testing::Contains(EndVerdict::kHangs)));
}

TEST(EndWatch, OneThatDoesNothingHangs) {
  // The threads of the middleware continue.
  const auto hangs = [](int second) { return Progress{0.001 * second, 0.001 * second, 7}; };
  const std::vector<EndVerdict> all = verdicts(20, hangs);
  EXPECT_EQ(all.back(), EndVerdict::kHangs);
  EXPECT_EQ(std::count(all.begin(), all.end(), EndVerdict::kHangs), 1);
  EXPECT_EQ(std::count(all.begin(), all.end(), EndVerdict::kReport), 3) << "after 5, 10 and 15 s";
}

TEST(EndWatch, OneThatStopsWorkingHangsFromThenOn) {
  const auto stops = [](int second) { return Progress{std::min(second, 100) * 0.3, 0.0, 0}; };
  const std::vector<EndVerdict> all = verdicts(200, stops);
  EXPECT_EQ(std::find(all.begin(), all.end(), EndVerdict::kHangs) - all.begin(), 100 + 20 - 1);
}

TEST(EndWatch, ReportsWhatItDoes) {
  EndWatch watch(Progress{10.0, 5.0, 0}, 100.0);
  EXPECT_EQ(watch.check(Progress{10.2, 5.5, 0}, 101.0), EndVerdict::kWaits);
  EXPECT_EQ(watch.check(Progress{11.2, 8.1, 0}, 105.0), EndVerdict::kReport);
  EXPECT_EQ(watch.text(), "it worked for 1.2 s and waited 3.1 s for a CPU in the last 5 s");
  EXPECT_EQ(watch.check(Progress{11.2, 8.2, 0, true}, 110.0), EndVerdict::kReport);
  EXPECT_EQ(watch.text(),
            "it worked for 0.0 s and waited 0.1 s for a CPU in the last 5 s, and waits for a disk "
            "now");
}

TEST(EndWatch, ReadsTheProgressOfAProcess) {
  const std::filesystem::path log =
      std::filesystem::path(testing::TempDir()) / "end_watch_test.log";
  ChildProcess busy("busy", "/bin/sh", {"-c", "while :; do :; done"}, log);
  ChildProcess idle("idle", "/bin/sleep", {"1000"}, log);
  EXPECT_TRUE(test::wait_for("a loop to use more CPU time than a sleep", [&] {
    return read_progress(busy.pid()).ran_s > read_progress(idle.pid()).ran_s + 0.05;
  }));
  const pid_t pid = busy.pid();
  busy.send_signal(SIGKILL);
  busy.wait();
  EXPECT_EQ(read_progress(pid).ran_s, 0.0) << "it is gone";
}

}  // namespace
}  // namespace topogeo::supervision
