#include "topogeo/goal_watch.hpp"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>

#include "topogeo/messaging/message.hpp"

#include "topogeo/goal_progress.hpp"

namespace topogeo::cli {
namespace {

using testing::HasSubstr;

msg::NavigatorStatus status(msg::NavigatorState state, msg::HaltReason reason = msg::kHaltNone,
                            const std::string& message = {}, std::uint64_t goal_id = 7) {
  msg::NavigatorStatus out;
  out.state(state);
  out.reason(reason);
  out.goal_id(goal_id);
  messaging::set_text(out.message(), message, "message");
  return out;
}

msg::Route refusal(msg::RouteStatus why, const std::string& message) {
  msg::Route route;
  route.goal_id(7);
  route.status(why);
  messaging::set_text(route.message(), message, "message");
  return route;
}

TEST(GoalWatch, IsDoneWhenTheRobotIsThere) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(msg::kNavigatorArrived, msg::kHaltNone, "", 6), 0.1);  // the goal before
  EXPECT_FALSE(watch.look(0.1));
  watch.add(status(msg::kNavigatorDriving), 1.0);
  EXPECT_FALSE(watch.look(1.0));
  watch.add(status(msg::kNavigatorArrived), 9.0);
  ASSERT_TRUE(watch.look(9.0));
  EXPECT_TRUE(watch.look(9.0)->arrived);
}

TEST(GoalWatch, ARefusalThatNothingChangesEndsIt) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(refusal(msg::kRouteUnknownPlace, "no place 'attic'"));
  watch.add(status(msg::kNavigatorStopped, msg::kHaltNoRoute), 1.0);
  ASSERT_TRUE(watch.look(1.0));
  EXPECT_FALSE(watch.look(1.0)->arrived);
  EXPECT_THAT(watch.look(1.0)->reason, HasSubstr("no place 'attic'"));
}

TEST(GoalWatch, WithoutAPoseThereIsHopeUntilPatienceEnds) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(refusal(msg::kRouteNoPose, "no pose"));
  for (double now_s = 1.0; now_s < 60.0; now_s += 1.0) {
    watch.add(status(msg::kNavigatorStopped, msg::kHaltNoRoute, "no pose"), now_s);
    ASSERT_FALSE(watch.look(now_s)) << now_s;
  }
  watch.add(status(msg::kNavigatorStopped, msg::kHaltPoseLost, "the pose is lost"), 61.0);
  ASSERT_TRUE(watch.look(61.0));
  EXPECT_EQ(watch.look(61.0)->reason, "the pose is lost");
}

TEST(GoalWatch, APauseMayLast) {
  GoalWatch watch(7, 60.0, 0.0);
  for (double now_s = 1.0; now_s < 300.0; now_s += 1.0) {
    watch.add(status(msg::kNavigatorStopped, msg::kHaltPaused), now_s);
    ASSERT_FALSE(watch.look(now_s)) << now_s;
  }
}

TEST(GoalWatch, SeesThatAnotherGoalCameOrTheNavigatorWent) {
  GoalWatch watch(7, 60.0, 0.0);
  watch.add(status(msg::kNavigatorDriving), 1.0);
  EXPECT_FALSE(watch.look(10.0));
  EXPECT_THAT(watch.look(12.0)->reason, HasSubstr("gone"));
  watch.add(status(msg::kNavigatorDriving, msg::kHaltNone, "", 8), 2.0);
  EXPECT_THAT(watch.look(2.0)->reason, HasSubstr("another goal"));
}

TEST(GoalProgress, SaysHowFarItIs) {
  msg::NavigatorStatus now = status(msg::kNavigatorDriving);
  now.driven_m(3.0);
  now.rest_m(9.0);
  now.rest_s(15.2);
  EXPECT_EQ(progress_line(now),
            "driving [######..................]  25 %, 9.0 m to go, about 16 s");
  EXPECT_EQ(progress_line(status(msg::kNavigatorBlocked, msg::kHaltObstacle, "a box")),
            "blocked: a box");
}

TEST(GoalProgress, ATerminalHasOneLineThatIsRedrawnAndKeepsWhatStopsTheRobot) {
  std::ostringstream out;
  GoalProgress progress(out, true, 30);
  progress.show(status(msg::kNavigatorDriving), 0.0);
  progress.show(status(msg::kNavigatorBlocked, msg::kHaltObstacle, "a box"), 1.0);
  progress.show(status(msg::kNavigatorDriving), 2.0);
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
    progress.show(status(msg::kNavigatorDriving), now_s);
  }
  progress.show(status(msg::kNavigatorArrived), 25.0);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

}  // namespace
}  // namespace topogeo::cli
