// The counters of a service that lacks CPU time, on a simulated clock and with made-up texts of
// /proc.
#include "topogeo/service/cpu_watch.hpp"

#include <fstream>
#include <map>

#include <gmock/gmock.h>

#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::service {
namespace {

namespace fs = std::filesystem;
using support::CpuShortage;
using testing::HasSubstr;

class CpuWatchTest : public testing::Test {
 protected:
  /// Passes `seconds`, in each of which the process runs and waits for so long, with late timers.
  void pass(int seconds, double ran_s, double waited_s, double timer_delay_s) {
    for (int i = 0; i < 4 * seconds; ++i) {  // about as often as in the service, at exact times
      now_s_ += 0.25;
      ran_s_ += 0.25 * ran_s;
      waited_s_ += 0.25 * waited_s;
      write_times();
      timer_delay_s_ = timer_delay_s;
      watch_.tick(now_s_);
    }
  }
  void crowd(int seconds) { pass(seconds, 0.1, 0.4, 0.3); }
  void free(int seconds) { pass(seconds, 0.4, 0.01, 0.001); }

  void write_times() const {
    constexpr double kSecond_ns = 1e9;
    const fs::path thread = process_ / "task" / "1";
    fs::create_directories(thread);
    std::ofstream(thread / "schedstat") << static_cast<long>(ran_s_ * kSecond_ns) << ' '
                                        << static_cast<long>(waited_s_ * kSecond_ns) << " 17\n";
  }

  support::TemporaryFolder folder_{"cpu_watch_test"};
  fs::path process_ = folder_.path() / "1";
  double now_s_ = 50.0;
  double ran_s_ = 0.0;
  double waited_s_ = 0.0;
  double timer_delay_s_ = 0.0;
  int delays_taken_ = 0;
  std::map<std::string, double> counters_;
  CpuWatch watch_{[this] {
                    ++delays_taken_;
                    return timer_delay_s_;
                  },
                  [this](const char* name, double value) { counters_[name] = value; },
                  support::CpuMeter(process_)};
};

TEST_F(CpuWatchTest, BeginsWithoutAShortage) {
  EXPECT_EQ(counters_.at(CpuWatch::kShort), 0.0);
  EXPECT_EQ(counters_.at(CpuWatch::kTimerDelay), 0.0);
  EXPECT_FALSE(watch_.lasts());
  EXPECT_EQ(watch_.text(), "");
}

TEST_F(CpuWatchTest, MeasuresOnceASecondHoweverOftenItIsCalled) {
  write_times();
  watch_.tick(now_s_);
  pass(3, 0.5, 0.25, 0.02);
  EXPECT_EQ(delays_taken_, 4);
  EXPECT_NEAR(counters_.at(CpuWatch::kWaitRatio), 0.25, 1e-6);
  EXPECT_DOUBLE_EQ(counters_.at(CpuWatch::kTimerDelay), 0.02);
  EXPECT_FALSE(watch_.lasts());
}

TEST_F(CpuWatchTest, AShortageThatLastsIsPublishedUntilItHasEnded) {
  free(2);
  crowd(CpuShortage::kBegins - 1);
  EXPECT_EQ(counters_.at(CpuWatch::kShort), 0.0) << "a second or two is no shortage";
  EXPECT_TRUE(watch_.is_short_now()) << "but a reason for a halt";
  crowd(2);
  EXPECT_EQ(counters_.at(CpuWatch::kShort), 1.0);
  EXPECT_THAT(watch_.text(), HasSubstr("the CPU is short: timers fire up to 0.3 s late, 80 %"));
  EXPECT_DOUBLE_EQ(watch_.timer_delay_s(), 0.3);
  free(CpuShortage::kEnds - 1);
  EXPECT_EQ(counters_.at(CpuWatch::kShort), 1.0) << "a load that comes and goes";
  free(2);
  EXPECT_EQ(counters_.at(CpuWatch::kShort), 0.0);
  EXPECT_EQ(watch_.text(), "");
}

TEST_F(CpuWatchTest, AKernelThatDoesNotCountShowsTheDelayAlone) {
  fs::create_directories(process_ / "task");
  for (int i = 0; i < 20; ++i) {
    timer_delay_s_ = 0.5;
    watch_.tick(now_s_ += 1.0);
  }
  EXPECT_DOUBLE_EQ(counters_.at(CpuWatch::kTimerDelay), 0.5);
  EXPECT_FALSE(counters_.contains(CpuWatch::kWaitRatio));
  EXPECT_EQ(counters_.at(CpuWatch::kShort), 0.0) << "a long handler would look the same";
}

}  // namespace
}  // namespace topogeo::service
