// Services that die and are restarted, on a simulated clock.
#include "topogeo/run/restart_log.hpp"

#include <gmock/gmock.h>

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(RestartLog, AServiceIsAwayFromItsDeathUntilItIsAtWork) {
  RestartLog log;
  EXPECT_EQ(log.at_work("localizer", 5.0), std::nullopt) << "it never died";
  EXPECT_EQ(log.died("localizer", 10.0).number, 1U);
  EXPECT_EQ(log.died("planner", 10.5).number, 1U);
  EXPECT_TRUE(log.is_away("localizer"));
  EXPECT_THAT(log.away(), ElementsAre("localizer", "planner"));
  EXPECT_EQ(log.at_work("localizer", 12.5), 2.5);
  EXPECT_FALSE(log.is_away("localizer"));
  EXPECT_EQ(log.at_work("localizer", 13.0), std::nullopt) << "each status says so again";
  EXPECT_THAT(log.away(), ElementsAre("planner"));
  EXPECT_EQ(log.died("localizer", 100.0).number, 2U);
}

TEST(RestartLog, OneThatDiesOfItsStartIsStartedLessAndLessOften) {
  RestartLog log;
  double now_s = 0.0;
  for (const int delay_ms : {100, 200, 400, 800, 1600, 3200, 5000, 5000}) {
    EXPECT_EQ(log.died("planner", now_s).delay, milliseconds(delay_ms));
    log.at_work("planner", now_s += 0.5);
    now_s += RestartLog::kSettled_s;  // not longer
  }
  for (int i = 0; i < 100; ++i) EXPECT_EQ(log.died("planner", now_s).delay, milliseconds(5000));
  EXPECT_EQ(log.died("localizer", now_s).delay, milliseconds(100)) << "each for itself";
}

TEST(RestartLog, OneThatHadSettledIsStartedAgainSoon) {
  RestartLog log;
  for (int i = 0; i < 5; ++i) log.died("planner", 0.0);
  log.at_work("planner", 1.0);
  EXPECT_EQ(log.died("planner", 1.25 + RestartLog::kSettled_s).delay, RestartLog::kFirstDelay);
}

TEST(RestartLog, OneThatDiesBeforeItIsAtWorkHasNotSettled) {
  RestartLog log;
  log.died("planner", 0.0);
  EXPECT_EQ(log.died("planner", 1000.0).delay, milliseconds(200));
}

TEST(RestartLog, OneThatIsFinishedHasWorkedAndOneThatWaitsHasNot) {
  EXPECT_TRUE(has_worked(msg::kServiceRunning));
  EXPECT_TRUE(has_worked(msg::kServiceFinished));
  for (const msg::ServiceState state :
       {msg::kServiceStarting, msg::kServiceWaiting, msg::kServiceFailed, msg::kServiceStopped}) {
    EXPECT_FALSE(has_worked(state)) << state;
  }
}

TEST(RestartLog, WhenAllBeginAgainNoneIsAway) {
  RestartLog log;
  log.died("planner", 0.0);
  log.clear();
  EXPECT_THAT(log.away(), IsEmpty());
  EXPECT_EQ(log.at_work("planner", 1.0), std::nullopt);
}

}  // namespace
}  // namespace topogeo::cli
