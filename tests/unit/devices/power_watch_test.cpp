#include "topogeo/devices/power_watch.hpp"

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

constexpr std::int64_t kReportPeriod_ns = 100'000'000;
constexpr double kAcceleration = 0.5;

/// One axis whose base reports ten times a second; commands reach it within 0.3 s.
class PowerWatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    watch_.aim_at(0.0, kAcceleration, 0);
    watch_.written(0);
    now_ns_ = 1'000'000'000;
  }
  void command(double speed) {
    watch_.aim_at(speed, kAcceleration, now_ns_);
    watch_.written(now_ns_);
  }
  /// The next report, a tenth of a second after the previous one. True: power is lost.
  bool report(double speed, McpPhase phase, double sign = 1.0) {
    now_ns_ += kReportPeriod_ns;
    // The base's clock has another origin.
    return watch_.take({now_ns_ - 123'456'789, now_ns_, speed, phase, sign});
  }
  /// Accelerates to the speed like a motor with power, and holds it.
  void reach(double speed) {
    command(speed);
    for (double now = 0.05; now < speed; now += 0.05) {
      ASSERT_FALSE(report(now, McpPhase::kAccelerate));
    }
    for (int i = 0; i < 5; ++i) ASSERT_FALSE(report(speed, McpPhase::kConstant));
  }

  PowerWatch watch_{{0.01, 0.012, 0.025}, kReportPeriod_ns};
  std::int64_t now_ns_ = 0;
};

TEST_F(PowerWatchTest, ADipWhileItRunsAtItsSpeedIsNoticedOnceTheNextReportBearsItOut) {
  reach(0.3);
  EXPECT_FALSE(report(0.2, McpPhase::kAccelerate)) << "it may be garbled";
  EXPECT_TRUE(report(0.25, McpPhase::kAccelerate));
}

TEST_F(PowerWatchTest, ASpeedThatComesBackAtOnceWasGarbledOnTheLine) {
  reach(0.3);
  EXPECT_FALSE(report(0.15, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.3, McpPhase::kConstant));
  EXPECT_FALSE(report(0.3, McpPhase::kConstant));
}

TEST_F(PowerWatchTest, AStartThatIsHeldIsNoticed) {
  command(0.3);
  EXPECT_FALSE(report(0.0, McpPhase::kStop)) << "the command is on its way";
  EXPECT_FALSE(report(0.0, McpPhase::kAccelerate)) << "it has just begun";
  EXPECT_FALSE(report(0.0, McpPhase::kAccelerate));
  EXPECT_TRUE(report(0.0, McpPhase::kAccelerate));
}

TEST_F(PowerWatchTest, ACommandThatWasNotHeardIsNoLossOfPower) {
  command(0.3);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(report(0.0, McpPhase::kStop)) << i;
  reach(0.3);
  command(0.1);
  command(0.4);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(report(0.3, McpPhase::kConstant)) << i;
  EXPECT_FALSE(report(0.35, McpPhase::kAccelerate)) << "heard at last";
  EXPECT_FALSE(report(0.4, McpPhase::kConstant));
}

TEST_F(PowerWatchTest, ASlowerCommandMayBeInForceForAWhile) {
  reach(0.3);
  command(0.2);
  command(0.3);
  EXPECT_FALSE(report(0.27, McpPhase::kDecelerate));
  EXPECT_FALSE(report(0.27, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.3, McpPhase::kConstant));
}

// The thread that writes to the port waits for a CPU, while this one has time.
TEST_F(PowerWatchTest, ACommandCountsOnceItIsWritten) {
  reach(0.3);
  command(0.0);
  watch_.aim_at(0.3, kAcceleration, now_ns_);
  EXPECT_FALSE(report(0.3, McpPhase::kConstant)) << "the halt is on its way";
  for (const double speed : {0.25, 0.2, 0.15, 0.1, 0.05}) {
    EXPECT_FALSE(report(speed, McpPhase::kDecelerate));
  }
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(report(0.0, McpPhase::kHalt)) << i;
  watch_.written(now_ns_);
  EXPECT_FALSE(report(0.0, McpPhase::kHalt));
  EXPECT_FALSE(report(0.0, McpPhase::kHalt)) << "it may take so long to obey";
  EXPECT_FALSE(report(0.05, McpPhase::kAccelerate));
}

TEST_F(PowerWatchTest, BrakesWithoutPowerAreHarderThanAMotor) {
  reach(0.4);
  command(0.0);
  EXPECT_FALSE(report(0.37, McpPhase::kDecelerate));
  EXPECT_FALSE(report(0.32, McpPhase::kDecelerate));
  EXPECT_FALSE(report(0.19, McpPhase::kDecelerate));
  EXPECT_TRUE(report(0.12, McpPhase::kDecelerate));
}

TEST_F(PowerWatchTest, RestThatNobodyHasCommandedIsNoticedAndAKnownReasonIsNone) {
  reach(0.3);
  bool noticed = false;
  for (const double speed : {0.25, 0.2, 0.15, 0.1, 0.05}) {
    noticed = noticed || report(speed, McpPhase::kDecelerate);
  }
  EXPECT_FALSE(noticed) << "it brakes with power: a joystick may be at work";
  EXPECT_FALSE(report(0.0, McpPhase::kHalt));
  EXPECT_TRUE(report(0.0, McpPhase::kHalt));
  watch_.forget();  // for example, after its watchdog
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(report(0.0, McpPhase::kHalt));
}

TEST_F(PowerWatchTest, AMotorThatGoesLimpInMotionHasLostItsPower) {
  reach(0.1);
  EXPECT_FALSE(report(0.06, McpPhase::kLimp));
  EXPECT_TRUE(report(0.03, McpPhase::kLimp));
}

TEST_F(PowerWatchTest, AnAxisThatSomebodyElseMovesIsLeftAlone) {
  reach(0.3);
  for (const double speed : {0.2, 0.1, -0.02, -0.07, -0.12, -0.17}) {
    EXPECT_FALSE(report(speed, speed > 0.0 ? McpPhase::kDecelerate : McpPhase::kAccelerate, -1.0));
  }
}

TEST_F(PowerWatchTest, AGapInTheReportsShowsNothingOfTheTimeInIt) {
  command(0.4);
  EXPECT_FALSE(report(0.05, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.1, McpPhase::kAccelerate));
  now_ns_ += 5 * kReportPeriod_ns;
  EXPECT_FALSE(report(0.15, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.2, McpPhase::kAccelerate));
}

// An emulated base stands still while its process gets no CPU time, but its clock continues.
TEST_F(PowerWatchTest, AClockThatGoesOnWhileTheAxisStandsStillIsNoLossOfPower) {
  constexpr double kFast = 1.5;
  watch_.aim_at(0.9, kFast, now_ns_);
  watch_.written(now_ns_);
  now_ns_ += 5 * kReportPeriod_ns;
  EXPECT_FALSE(report(0.0, McpPhase::kStop));
  EXPECT_FALSE(report(0.15, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.30, McpPhase::kAccelerate));
  now_ns_ += 8 * kReportPeriod_ns;
  EXPECT_FALSE(report(0.45, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.60, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.75, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.75, McpPhase::kAccelerate)) << "it may be garbled";
  EXPECT_TRUE(report(0.75, McpPhase::kAccelerate)) << "it is held";
}

TEST_F(PowerWatchTest, ASlowStartThatAGapInterruptsIsNoRest) {
  command(0.03);
  now_ns_ += 4 * kReportPeriod_ns;
  EXPECT_FALSE(report(0.0, McpPhase::kStop));
  EXPECT_FALSE(report(0.0, McpPhase::kAccelerate));
  now_ns_ += 8 * kReportPeriod_ns;
  EXPECT_FALSE(report(0.005, McpPhase::kAccelerate)) << "it has just begun";
  EXPECT_FALSE(report(0.015, McpPhase::kAccelerate));
  EXPECT_FALSE(report(0.03, McpPhase::kConstant));
}

}  // namespace
}  // namespace topogeo::devices
