#include "topogeo/devices/base_interlocks.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

constexpr std::uint16_t kNoBumper = 0xFFFF;
constexpr std::uint16_t kFirstBumper = 0xFFFE;

class BaseInterlocksTest : public ::testing::Test {
 protected:
  BaseInterlocks interlocks_{BaseSettings{}};  // commands are valid for 0.5 s
};

TEST_F(BaseInterlocksTest, AStopHoldsUntilItIsReleased) {
  EXPECT_FALSE(interlocks_.engaged());
  EXPECT_TRUE(interlocks_.emergency_stop());
  EXPECT_FALSE(interlocks_.emergency_stop()) << "it was stopped before";
  interlocks_.halt();
  EXPECT_EQ(interlocks_.state(), BaseState::kEmergencyStop) << "it goes before the halt";
  interlocks_.motion_taken();
  interlocks_.offline();
  EXPECT_TRUE(interlocks_.engaged());
  interlocks_.release();
  EXPECT_FALSE(interlocks_.engaged());
  EXPECT_EQ(interlocks_.state(), std::nullopt);
}

TEST_F(BaseInterlocksTest, ABumpHoldsAsLongAsTheCommandsThatLedToIt) {
  EXPECT_FALSE(interlocks_.bumpers(kNoBumper, 0.3, 0));
  EXPECT_TRUE(interlocks_.bumpers(kFirstBumper, 0.3, 0));
  EXPECT_FALSE(interlocks_.bumpers(kFirstBumper, 0.3, 0)) << "the same switch again";
  EXPECT_EQ(interlocks_.pressed(), 1U);
  interlocks_.motion_commanded(300'000'000);
  interlocks_.tick(500'000'000);
  EXPECT_TRUE(interlocks_.engaged());
  EXPECT_EQ(interlocks_.due_ns(), 800'000'000);
  interlocks_.tick(800'000'000);
  EXPECT_FALSE(interlocks_.engaged()) << "backing off is free";
  EXPECT_EQ(interlocks_.state(), BaseState::kBumped) << "a switch is pressed";
  EXPECT_FALSE(interlocks_.bumpers(kNoBumper, 0.3, 0));
  EXPECT_EQ(interlocks_.state(), std::nullopt);
  EXPECT_EQ(interlocks_.due_ns(), std::numeric_limits<std::int64_t>::max());
}

TEST_F(BaseInterlocksTest, AnExpiryOfTheWatchdogHoldsNothingAndPasses) {
  interlocks_.watchdog_expired(1'000'000'000);
  EXPECT_FALSE(interlocks_.engaged());
  EXPECT_EQ(interlocks_.state(), BaseState::kWatchdogExpired);
  const std::int64_t end_ns = 1'000'000'000 + BaseInterlocks::kWatchdogShown_ns;
  EXPECT_EQ(interlocks_.due_ns(), end_ns);
  interlocks_.tick(end_ns - 1);
  EXPECT_EQ(interlocks_.state(), BaseState::kWatchdogExpired);
  interlocks_.tick(end_ns);
  EXPECT_EQ(interlocks_.state(), std::nullopt);
  interlocks_.watchdog_expired(end_ns);
  interlocks_.motion_taken();
  EXPECT_EQ(interlocks_.state(), std::nullopt);
}

TEST_F(BaseInterlocksTest, ACommandToStandEndsABumpAndMotionEndsAFault) {
  EXPECT_TRUE(interlocks_.bumpers(kFirstBumper, 0.3, 0));
  interlocks_.standing_taken();
  EXPECT_FALSE(interlocks_.engaged());
  EXPECT_TRUE(interlocks_.motor_event(McpEventKind::kRotateCurrent));
  EXPECT_EQ(interlocks_.motor_fault(), "rotation motor: current");
  interlocks_.motion_taken();
  EXPECT_EQ(interlocks_.motor_fault(), "");
}

TEST_F(BaseInterlocksTest, StopsOfAnEarlierProcessHoldUntilTheRelease) {
  interlocks_.hold({});
  EXPECT_FALSE(interlocks_.engaged());
  interlocks_.hold({true, false});
  EXPECT_EQ(interlocks_.state(), BaseState::kEmergencyStop);
  interlocks_.hold({false, true});
  EXPECT_EQ(interlocks_.held(), (HeldStops{true, true}));
  interlocks_.offline();
  EXPECT_TRUE(interlocks_.engaged());
  interlocks_.release();
  EXPECT_FALSE(interlocks_.engaged());
  EXPECT_EQ(interlocks_.held(), (HeldStops{false, false}));
}

TEST_F(BaseInterlocksTest, NothingPushesWhileABumperIsPressed) {
  EXPECT_TRUE(interlocks_.bumpers(kFirstBumper, 0.3, 0));
  interlocks_.standing_taken();
  EXPECT_TRUE(interlocks_.pushes(0.1));
  EXPECT_FALSE(interlocks_.pushes(-0.1));
  EXPECT_FALSE(interlocks_.pushes(0.0)) << "a turn on the spot";
  interlocks_.bumpers(kNoBumper, 0.0, 1);
  EXPECT_FALSE(interlocks_.pushes(0.1));
  EXPECT_TRUE(interlocks_.bumpers(kFirstBumper, -0.2, 2));
  EXPECT_TRUE(interlocks_.pushes(-0.1));
  EXPECT_FALSE(interlocks_.pushes(0.1));
  interlocks_.bumpers(kNoBumper, 0.0, 3);
  EXPECT_TRUE(interlocks_.bumpers(kFirstBumper, 0.0, 4)) << "pressed while it stands";
  EXPECT_FALSE(interlocks_.pushes(0.1));
}

TEST_F(BaseInterlocksTest, OnlyEventsOfTheMotorsAreFaults) {
  EXPECT_FALSE(interlocks_.motor_event(McpEventKind::kBatteryLow));
  EXPECT_TRUE(interlocks_.motor_event(McpEventKind::kTranslateError));
  EXPECT_FALSE(interlocks_.motor_event(McpEventKind::kBump));
  EXPECT_EQ(interlocks_.motor_fault(), "translation motor: servo error");
  EXPECT_FALSE(interlocks_.motor_event(McpEventKind::kErrorCleared));
  EXPECT_EQ(interlocks_.motor_fault(), "");
}

TEST_F(BaseInterlocksTest, TheJoystickIsNoticedOnceEachTime) {
  EXPECT_FALSE(interlocks_.joystick(false));
  EXPECT_TRUE(interlocks_.joystick(true));
  EXPECT_FALSE(interlocks_.joystick(true));
  EXPECT_FALSE(interlocks_.joystick(false));
  EXPECT_TRUE(interlocks_.joystick(true));
}

}  // namespace
}  // namespace topogeo::devices
