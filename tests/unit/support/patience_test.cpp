// Patience on simulated clocks, and with made-up texts of /proc.
#include "topogeo/support/patience.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::support {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(PatienceClock, CountsTheTimeBetweenCalls) {
  PatienceClock clock(100.0);
  EXPECT_DOUBLE_EQ(clock.advance(100.5), 0.5);
  EXPECT_DOUBLE_EQ(clock.advance(101.25), 1.25);
  EXPECT_DOUBLE_EQ(clock.time_s(), 1.25);
}

TEST(PatienceClock, ASpanInWhichTheProcessDidNotRunCountsForTheLongestSpan) {
  PatienceClock clock(0.0);
  EXPECT_DOUBLE_EQ(clock.advance(3600.0), PatienceClock::kLongestSpan_s);
  PatienceClock short_span(0.0, 0.25);
  EXPECT_DOUBLE_EQ(short_span.advance(3600.0), 0.25);
}

TEST(PatienceClock, ABusyMachineTakesSixTimesAsLong) {
  PatienceClock clock(0.0);
  for (int i = 1; i <= 60; ++i) clock.advance(0.5 * i, PatienceClock::kBusyRate);
  EXPECT_NEAR(clock.time_s(), 5.0, 1e-9);
  EXPECT_NEAR(clock.advance(30.5, 0.0), 5.0, 1e-9) << "a rate of 0 holds the clock";
}

TEST(PatienceClock, ATimeOfBeforeCountsForNothing) {
  PatienceClock clock(10.0);
  EXPECT_DOUBLE_EQ(clock.advance(9.0), 0.0);
}

TEST(PatienceWindow, WaitsAreOverAPatienceAfterTheirBeginning) {
  PatienceWindow window(10.0, 100.0);
  for (double now_s = 100.5; now_s < 110.0; now_s += 0.5) {
    ASSERT_EQ(window.over_before(now_s), std::nullopt) << now_s;
  }
  EXPECT_EQ(window.over_before(110.0), 100.0);
  EXPECT_EQ(window.over_before(110.5), 100.5);
  EXPECT_EQ(window.over_before(111.5), 101.5) << "calls may be further apart";
}

TEST(PatienceWindow, ATimeThatDoesNotCountPutsTheMomentBack) {
  PatienceWindow window(10.0, 0.0);
  for (double now_s = 0.5; now_s <= 60.0; now_s += 0.5) {  // counts for 10 s
    const auto over = window.over_before(now_s, PatienceClock::kBusyRate);
    ASSERT_TRUE(!over || now_s > 59.0) << now_s;
  }
  for (double now_s = 60.5; now_s <= 69.0; now_s += 0.5) {
    const auto over = window.over_before(now_s);
    ASSERT_TRUE(over);
    ASSERT_LE(*over, 60.0) << "a wait that began when the machine had time is not over";
  }
  const auto over = window.over_before(3600.0);
  ASSERT_TRUE(over);
  EXPECT_LE(*over, 61.0) << "a process that stood still has heard nothing";
}

/// A process of /proc whose thread runs and waits as the test sets.
class PatienceTest : public testing::Test {
 protected:
  /// Adds `ran_s` of work and `waited_s` of waiting for a CPU to the thread.
  void work(double ran_s, double waited_s) {
    ran_s_ += ran_s;
    waited_s_ += waited_s;
    constexpr double kSecond_ns = 1e9;
    const fs::path thread = process_ / "task" / "1";
    fs::create_directories(thread);
    std::ofstream(thread / "schedstat") << static_cast<long>(ran_s_ * kSecond_ns) << ' '
                                        << static_cast<long>(waited_s_ * kSecond_ns) << " 17\n";
  }
  /// Checks a patience of 4.9 s every half second until it is over; returns that time.
  double end_s(Patience& patience, double ran_s, double waited_s) {
    for (double now_s = 0.5; now_s < 1000.0; now_s += 0.5) {
      work(ran_s, waited_s);
      if (patience.is_over(now_s)) return now_s;
    }
    return 1000.0;
  }

  TemporaryFolder folder_{"patience_test"};
  fs::path process_ = folder_.path() / "1";

 private:
  double ran_s_ = 0.0;
  double waited_s_ = 0.0;
};

TEST_F(PatienceTest, IsAsGivenWhereTheMachineIsFree) {
  work(1.0, 9.0);  // earlier work
  Patience patience(4.9, 0.0, CpuMeter(process_));
  EXPECT_DOUBLE_EQ(end_s(patience, 0.01, 0.0), 5.0);
  EXPECT_EQ(patience.reason(), "");
}

TEST_F(PatienceTest, IsProlongedByTheShareOfWaitingAndNamesIt) {
  work(0.0, 0.0);
  Patience patience(4.9, 0.0, CpuMeter(process_));
  EXPECT_DOUBLE_EQ(end_s(patience, 0.1, 0.3), 20.0);
  EXPECT_THAT(patience.reason(), HasSubstr("; this machine is too busy: the wait of 5.0 s took "
                                           "20.0 s, and this program waited for a CPU 75 %"));
}

TEST_F(PatienceTest, EndsOnAMachineThatHasNoTimeAtAll) {
  work(0.0, 0.0);
  Patience patience(4.9, 0.0, CpuMeter(process_));
  EXPECT_DOUBLE_EQ(end_s(patience, 0.0, 0.5), 29.5) << "six times as long";
}

TEST_F(PatienceTest, IsAsGivenWhereTheKernelDoesNotCount) {
  Patience patience(4.9, 0.0, CpuMeter(folder_.path() / "none"));
  double now_s = 0.0;
  while (!patience.is_over(now_s)) now_s += 0.5;
  EXPECT_DOUBLE_EQ(now_s, 5.0);
}

TEST_F(PatienceTest, BeginsAgainWhenSomethingCame) {
  work(0.0, 0.0);
  Patience patience(4.9, 0.0, CpuMeter(process_));
  for (double now_s = 0.5; now_s <= 4.5; now_s += 0.5) ASSERT_FALSE(patience.is_over(now_s));
  patience.begin_again(4.5);
  for (double now_s = 5.0; now_s <= 9.0; now_s += 0.5) ASSERT_FALSE(patience.is_over(now_s));
  EXPECT_TRUE(patience.is_over(9.5));
}

}  // namespace
}  // namespace topogeo::support
