#include "topogeo/supervision/goal_watch.hpp"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>

#include "topogeo/supervision/goal_progress.hpp"

namespace topogeo::supervision {
namespace {

using navigation::HaltReason;
using navigation::NavigatorState;
using navigation::NavigatorStatus;
using testing::HasSubstr;

NavigatorStatus status(NavigatorState state, HaltReason reason = HaltReason::kNone,
                       const std::string& message = {}, std::uint64_t goal_id = 7) {
  NavigatorStatus out;
  out.state = state;
  out.reason = reason;
  out.goal_id = goal_id;
  out.message = message;
  return out;
}

TEST(GoalWatch, IsDoneWhenTheRobotIsThere) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(NavigatorState::kArrived, HaltReason::kNone, "", 6), 0.1);  // the goal before
  EXPECT_FALSE(watch.check(0.1));
  watch.add(status(NavigatorState::kDriving), 1.0);
  EXPECT_FALSE(watch.check(1.0));
  watch.add(status(NavigatorState::kArrived), 9.0);
  ASSERT_TRUE(watch.check(9.0));
  EXPECT_TRUE(watch.check(9.0)->arrived);
}

TEST(GoalWatch, ARefusalThatNothingChangesEndsIt) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(RouteAnswer{7, true, "no place 'attic'"});
  watch.add(status(NavigatorState::kStopped, HaltReason::kNoRoute), 1.0);
  ASSERT_TRUE(watch.check(1.0));
  EXPECT_FALSE(watch.check(1.0)->arrived);
  EXPECT_THAT(watch.check(1.0)->reason, HasSubstr("no place 'attic'"));
}

TEST(GoalWatch, WithoutAPoseThereIsHopeUntilPatienceEnds) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(RouteAnswer{7, false, "no pose"});
  for (double now_s = 1.0; now_s <= 60.0; now_s += 1.0) {
    watch.add(status(NavigatorState::kStopped, HaltReason::kNoRoute, "no pose"), now_s);
    ASSERT_FALSE(watch.check(now_s)) << now_s;
  }
  watch.add(status(NavigatorState::kStopped, HaltReason::kPoseLost, "the pose is lost"), 61.0);
  ASSERT_TRUE(watch.check(61.0));
  EXPECT_EQ(watch.check(61.0)->reason, "the pose is lost");
}

TEST(GoalWatch, APauseMayLast) {
  GoalWatch watch(7, 60.0, 0.0);
  for (double now_s = 1.0; now_s < 300.0; now_s += 1.0) {
    watch.add(status(NavigatorState::kStopped, HaltReason::kPaused), now_s);
    ASSERT_FALSE(watch.check(now_s)) << now_s;
  }
}

TEST(GoalWatch, SeesThatAnotherGoalCameOrTheNavigatorWent) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(NavigatorState::kDriving), 1.0);
  for (double now_s = 1.0; now_s <= 11.0; now_s += 0.5) {
    EXPECT_FALSE(watch.check(now_s)) << now_s;
  }
  EXPECT_THAT(watch.check(12.0)->reason, HasSubstr("gone"));
  watch.add(status(NavigatorState::kDriving, HaltReason::kNone, "", 8), 13.0);
  EXPECT_THAT(watch.check(13.0)->reason, HasSubstr("another goal"));
}

TEST(GoalWatch, TellsAGoalThatWasTakenAwayFromOneThatEnded) {
  GoalWatch replaced(7, 60.0, 0.0);
  replaced.add(status(NavigatorState::kDriving), 1.0);
  EXPECT_FALSE(replaced.was_taken_away());
  replaced.add(status(NavigatorState::kDriving, HaltReason::kNone, "", 8), 2.0);
  EXPECT_TRUE(replaced.was_taken_away());

  GoalWatch cancelled(7, 60.0, 0.0);
  cancelled.add(status(NavigatorState::kStopped, HaltReason::kCancelled, "", 6), 1.0);
  EXPECT_FALSE(cancelled.was_taken_away()) << "the goal before";
  cancelled.add(status(NavigatorState::kStopped, HaltReason::kCancelled), 2.0);
  EXPECT_TRUE(cancelled.was_taken_away());

  GoalWatch lost(7, 60.0, 0.0);
  lost.add(status(NavigatorState::kDriving), 1.0);
  lost.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), 2.0);
  EXPECT_FALSE(lost.was_taken_away()) << "the navigator may have started again";
  for (double now_s = 2.5; now_s <= 8.0; now_s += 0.5) {
    lost.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), now_s);
  }
  EXPECT_TRUE(lost.was_taken_away());

  GoalWatch arrived(7, 60.0, 0.0);
  arrived.add(status(NavigatorState::kArrived), 1.0);
  arrived.add(status(NavigatorState::kStopped, HaltReason::kNoRoute), 2.0);
  EXPECT_FALSE(arrived.was_taken_away());
}

TEST(GoalWatch, KnowsWhetherTheNavigatorHasTheGoal) {
  GoalWatch watch(7, 60.0, 0.0);
  EXPECT_FALSE(watch.in_hand());
  watch.add(status(NavigatorState::kDriving, HaltReason::kNone, "", 6), 0.1);  // the goal before
  EXPECT_FALSE(watch.in_hand());
  watch.add(status(NavigatorState::kDriving), 1.0);
  EXPECT_TRUE(watch.in_hand());
  watch.add(status(NavigatorState::kStopped, HaltReason::kPaused), 2.0);
  EXPECT_TRUE(watch.in_hand()) << "a resume drives on";
  watch.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), 3.0);
  EXPECT_FALSE(watch.in_hand());
  watch.add(status(NavigatorState::kDriving), 4.0);
  EXPECT_TRUE(watch.in_hand()) << "the navigator started again";
  watch.add(status(NavigatorState::kStopped, HaltReason::kCancelled), 5.0);
  EXPECT_FALSE(watch.in_hand());
}

TEST(GoalWatch, ASpanInWhichThisProgramDidNotRunIsNoSilenceOfTheNavigator) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(NavigatorState::kDriving), 1.0);
  EXPECT_FALSE(watch.check(500.0)) << "the statuses of this time are unread";
  watch.add(status(NavigatorState::kStopped, HaltReason::kNoOdometry, "no odometry"), 500.1);
  EXPECT_FALSE(watch.check(900.0));
  watch.add(status(NavigatorState::kDriving), 900.1);
  EXPECT_FALSE(watch.check(900.2));
}

TEST(GoalWatch, ARobotWhoseMachineIsBusyIsNotGivenUp) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(NavigatorState::kDriving), 1.0);
  watch.set_busy(true, 1.0);
  for (double now_s = 1.0; now_s <= 1000.0; now_s += 0.5) {
    watch.add(status(NavigatorState::kStopped, HaltReason::kNoOdometry, "the CPU is short"), now_s);
    ASSERT_FALSE(watch.check(now_s)) << now_s;
  }
  for (double now_s = 1000.0; now_s <= 1100.0; now_s += 0.5) {
    ASSERT_FALSE(watch.check(now_s)) << "statuses come late, too";
  }
  watch.set_busy(false, 1100.0);
  for (double now_s = 1100.0; now_s <= 1159.0; now_s += 0.5) {
    watch.add(status(NavigatorState::kStopped, HaltReason::kNoOdometry, "no odometry"), now_s);
    ASSERT_FALSE(watch.check(now_s)) << now_s;
  }
  watch.add(status(NavigatorState::kStopped, HaltReason::kNoOdometry, "no odometry"), 1160.0);
  ASSERT_TRUE(watch.check(1160.5)) << "the machine has had time for a minute";
  EXPECT_EQ(watch.check(1160.5)->reason, "no odometry");
}

TEST(GoalWatch, ANavigatorThatStartsAgainGetsTheGoalAgain) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(NavigatorState::kDriving), 1.0);
  watch.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), 3.0);
  EXPECT_FALSE(watch.check(3.0));
  watch.add(status(NavigatorState::kDriving), 4.0);
  watch.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), 20.0);
  EXPECT_FALSE(watch.check(20.0));
  for (double now_s = 20.0; now_s < 26.0; now_s += 0.2) {
    watch.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), now_s);
  }
  watch.add(status(NavigatorState::kIdle, HaltReason::kNone, "", 0), 26.0);
  EXPECT_THAT(watch.check(26.0)->reason, HasSubstr("cancelled"));
}

TEST(GoalProgress, ShowsHowFarItIs) {
  NavigatorStatus now = status(NavigatorState::kDriving);
  now.driven_m = 3.0;
  now.rest_m = 9.0;
  now.rest_s = 15.2;
  EXPECT_EQ(progress_line(now),
            "driving [######..................]  25 %, 9.0 m to go, about 16 s");
  EXPECT_EQ(progress_line(status(NavigatorState::kBlocked, HaltReason::kObstacle, "a box")),
            "blocked: a box");
}

TEST(GoalProgress, ATerminalHasOneLineThatIsRedrawnAndKeepsWhatStopsTheRobot) {
  std::ostringstream out;
  GoalProgress progress(out, true, 30);
  progress.show(status(NavigatorState::kDriving), 0.0);
  progress.show(status(NavigatorState::kBlocked, HaltReason::kObstacle, "a box"), 1.0);
  progress.show(status(NavigatorState::kDriving), 2.0);
  progress.finish();
  const std::string text = out.str();
  EXPECT_THAT(text, HasSubstr("blocked: a box\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, HasSubstr("\rdriving [...................."));  // cut to the terminal
}

TEST(GoalProgress, APipeHasALineForEachChangeAndOneEveryTenSeconds) {
  std::ostringstream out;
  GoalProgress progress(out, false);
  for (double now_s = 0.0; now_s < 25.0; now_s += 0.2) {
    progress.show(status(NavigatorState::kDriving), now_s);
  }
  progress.show(status(NavigatorState::kArrived), 25.0);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

}  // namespace
}  // namespace topogeo::supervision
