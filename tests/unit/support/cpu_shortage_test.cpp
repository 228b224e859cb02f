// The CPU time of a process, from made-up texts of /proc, and when it is reported as short.
#include "topogeo/support/cpu_shortage.hpp"

#include <fstream>
#include <thread>

#include <gmock/gmock.h>

#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::support {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A process of /proc whose threads have times set by the test.
class CpuMeterTest : public testing::Test {
 protected:
  void set_thread(long number, double ran_s, double waited_s) const {
    constexpr double kSecond_ns = 1e9;
    const fs::path folder = process_ / "task" / std::to_string(number);
    fs::create_directories(folder);
    std::ofstream(folder / "schedstat") << static_cast<long>(ran_s * kSecond_ns) << ' '
                                        << static_cast<long>(waited_s * kSecond_ns) << " 17\n";
  }
  void end_thread(long number) const { fs::remove_all(process_ / "task" / std::to_string(number)); }

  TemporaryFolder folder_{"cpu_meter_test"};
  fs::path process_ = folder_.path() / "123";
  CpuMeter meter_{process_};
};

TEST_F(CpuMeterTest, SumsUpTheThreads) {
  set_thread(123, 10.0, 5.0);
  set_thread(124, 1.0, 0.0);
  EXPECT_FALSE(meter_.take(100.0)) << "times from before are of no span";
  set_thread(123, 10.5, 6.5);
  set_thread(124, 1.25, 0.25);
  const auto use = meter_.take(102.0);
  ASSERT_TRUE(use);
  EXPECT_DOUBLE_EQ(use->span_s, 2.0);
  EXPECT_NEAR(use->ran_s, 0.75, 1e-6);
  EXPECT_NEAR(use->waited_s, 1.75, 1e-6);
  EXPECT_NEAR(use->wait_ratio(), 0.875, 1e-6) << "of one thread, all the time";
  EXPECT_NEAR(use->wait_share(), 0.7, 1e-6);
}

TEST_F(CpuMeterTest, ThreadsComeAndGo) {
  set_thread(123, 10.0, 5.0);
  set_thread(124, 100.0, 50.0);
  (void)meter_.take(100.0);
  end_thread(124);
  set_thread(125, 0.5, 0.5);
  auto use = meter_.take(101.0);
  ASSERT_TRUE(use);
  EXPECT_NEAR(use->ran_s, 0.5, 1e-6);
  EXPECT_NEAR(use->waited_s, 0.5, 1e-6);
  set_thread(125, 0.1, 0.1);  // another thread got the number
  use = meter_.take(102.0);
  EXPECT_EQ(use->ran_s, 0.0);
  EXPECT_EQ(use->waited_s, 0.0);
}

TEST_F(CpuMeterTest, AKernelThatDoesNotCountGivesNothing) {
  fs::create_directories(process_ / "task/123");
  EXPECT_FALSE(meter_.take(100.0));
  EXPECT_FALSE(meter_.take(101.0));
}

TEST(CpuMeter, ThisProcessRuns) {
  CpuMeter meter;
  if (thread_times("/proc/self").empty()) GTEST_SKIP() << "this kernel does not count";
  (void)meter.take(0.0);
  double work = 1.0;
  const double before_s = sum_of(thread_times("/proc/self")).ran_s;
  while (sum_of(thread_times("/proc/self")).ran_s < before_s + 0.05) work *= 1.0000001;
  const auto use = meter.take(1.0);
  ASSERT_TRUE(use);
  EXPECT_GE(use->ran_s, 0.05) << work;
}

// --- CpuShortage

constexpr CpuUse kCrowded{1.0, 0.1, 0.4};
constexpr CpuUse kFree{1.0, 0.4, 0.01};
constexpr double kLateTimer_s = 0.4;

void add_times(CpuShortage& shortage, int times, const CpuUse& use, double timer_delay_s) {
  for (int i = 0; i < times; ++i) shortage.add(use, timer_delay_s);
}

TEST(CpuShortage, LateTimersAndWaitingThreadsAreOne) {
  CpuShortage shortage;
  add_times(shortage, CpuShortage::kBegins - 1, kCrowded, kLateTimer_s);
  EXPECT_FALSE(shortage.lasts()) << "it has not lasted";
  EXPECT_TRUE(shortage.add(kCrowded, kLateTimer_s));
  EXPECT_TRUE(shortage.lasts());
  EXPECT_THAT(shortage.text(), HasSubstr("the CPU is short: timers fire up to 0.4 s late, 80 %"));
}

TEST(CpuShortage, NeitherALongHandlerNorASearchOnAllCpusIsOne) {
  CpuShortage shortage;
  add_times(shortage, 100, kFree, kLateTimer_s);
  EXPECT_FALSE(shortage.lasts()) << "its own work made the timers late";
  add_times(shortage, 100, kCrowded, 0.001);
  EXPECT_FALSE(shortage.lasts()) << "nothing comes late";
}

TEST(CpuShortage, ASecondNowAndThenDoesNotBeginOne) {
  CpuShortage shortage;
  for (int i = 0; i < 100; ++i) {
    add_times(shortage, CpuShortage::kBegins - 1, kCrowded, kLateTimer_s);
    shortage.add(kFree, 0.0);
  }
  EXPECT_FALSE(shortage.lasts());
}

TEST(CpuShortage, DoesNotComeAndGoNearAThreshold) {
  CpuShortage shortage;
  add_times(shortage, CpuShortage::kBegins, kCrowded, kLateTimer_s);
  int changes = 0;
  for (int i = 0; i < 100; ++i) {
    // Slightly below and above the threshold of a shortage, with a good second now and then.
    if (shortage.add(kCrowded, CpuShortage::kLate_s + (i % 2 == 0 ? 0.01 : -0.01))) ++changes;
    if (i % 3 == 0 && shortage.add(kFree, 0.0)) ++changes;
  }
  EXPECT_EQ(changes, 0);
  EXPECT_TRUE(shortage.lasts());
  shortage.add(kCrowded, kLateTimer_s);
  add_times(shortage, CpuShortage::kEnds - 1, kFree, 0.0);
  EXPECT_TRUE(shortage.lasts());
  EXPECT_TRUE(shortage.add(kFree, 0.0));
  EXPECT_FALSE(shortage.lasts());
}

}  // namespace
}  // namespace topogeo::support
