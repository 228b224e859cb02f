// A run that sends a robot to a goal, on a simulated clock.
#include "topogeo/supervision/goto_phases.hpp"

#include <gmock/gmock.h>

namespace topogeo::supervision {
namespace {

using testing::HasSubstr;

class GotoPhasesTest : public testing::Test {
 protected:
  /// Four calls a second for so long; ends early with the first action other than kNone.
  GotoAction pass(double duration_s, const GotoView& view) {
    for (int i = 0; i < static_cast<int>(4.0 * duration_s); ++i) {
      now_s_ += 0.25;
      const GotoAction action = phases_.step(now_s_, view);
      if (action != GotoAction::kNone) return action;
    }
    return GotoAction::kNone;
  }
  void set_out() { ASSERT_EQ(pass(0.25, {}), GotoAction::kSendGoal); }

  double now_s_ = 100.0;
  GotoPhases phases_{now_s_};
};

TEST_F(GotoPhasesTest, SendsTheGoalOnceNothingLacks) {
  EXPECT_EQ(pass(60.0, {"the map", "", {}, true}), GotoAction::kNone);
  EXPECT_TRUE(phases_.is_waiting());
  set_out();
  EXPECT_TRUE(phases_.is_driving());
  EXPECT_EQ(pass(500.0, {}), GotoAction::kNone) << "a goal has its own patience";
  EXPECT_EQ(pass(1.0, {"", "", GoalEnd{true, ""}, true}), GotoAction::kEnd);
  EXPECT_TRUE(phases_.has_arrived());
  EXPECT_DOUBLE_EQ(phases_.drive_s(), 500.25);
  EXPECT_EQ(phases_.failure(), "");
  EXPECT_EQ(pass(500.0, {"the map", "", GoalEnd{false, "gone"}, false}), GotoAction::kNone);
  EXPECT_TRUE(phases_.has_arrived()) << "what comes later changes nothing";
}

TEST_F(GotoPhasesTest, AStartThatTakesTooLongFailsAndNamesWhatLacks) {
  EXPECT_EQ(pass(119.75, {"the first pose", "", {}, true}), GotoAction::kNone);
  EXPECT_EQ(pass(1.0, {"the first pose", "", {}, true}), GotoAction::kFail);
  EXPECT_EQ(phases_.failure(), "still waits for the first pose after 120 s");
  EXPECT_FALSE(phases_.call_off()) << "no goal was sent";
}

TEST_F(GotoPhasesTest, ABusyMachineMayTakeAnyTimeForTheStart) {
  EXPECT_EQ(pass(3600.0, {"the map", "the CPU is short for localizer", {}, true}),
            GotoAction::kNone);
  EXPECT_EQ(pass(119.75, {"the map", "", {}, true}), GotoAction::kNone);
  set_out();
}

TEST_F(GotoPhasesTest, ATimeInWhichTheProgramStoodStillIsNoWait) {
  now_s_ += 3600.0;
  EXPECT_EQ(pass(118.0, {"the map", "", {}, true}), GotoAction::kNone);
  set_out();
}

TEST_F(GotoPhasesTest, AGoalThatIsGivenUpIsCalledOffUntilTheRobotStands) {
  set_out();
  EXPECT_EQ(pass(1.0, {"", "", GoalEnd{false, "no route: a wall"}, false}), GotoAction::kCallOff);
  EXPECT_FALSE(phases_.has_arrived());
  EXPECT_EQ(phases_.failure(), "no route: a wall");
  EXPECT_FALSE(phases_.call_off()) << "it has been";
  EXPECT_EQ(pass(3.0, {"", "", GoalEnd{false, "cancelled"}, false}), GotoAction::kNone);
  EXPECT_EQ(pass(1.0, {"", "", GoalEnd{false, "cancelled"}, true}), GotoAction::kEnd);
  EXPECT_EQ(phases_.failure(), "no route: a wall") << "the first reason stays";
}

TEST_F(GotoPhasesTest, ARobotThatDoesNotStopHoldsTheEndUpForFiveSecondsOfAFreeMachine) {
  set_out();
  EXPECT_TRUE(phases_.call_off()) << "by the operator";
  EXPECT_EQ(pass(60.0, {"", "the CPU is short for gateway", {}, false}), GotoAction::kNone);
  EXPECT_EQ(pass(5.0, {"", "", {}, false}), GotoAction::kNone);
  EXPECT_EQ(pass(0.25, {"", "", {}, false}), GotoAction::kEnd);
  EXPECT_FALSE(phases_.has_arrived());
}

TEST_F(GotoPhasesTest, MayBeCalledOffBeforeTheGoalIsSent) {
  EXPECT_TRUE(phases_.call_off());
  EXPECT_EQ(pass(0.25, {"the services", "", {}, true}), GotoAction::kEnd);
}

}  // namespace
}  // namespace topogeo::supervision
