#include "topogeo/devices/motion_monitor.hpp"

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

class MotionMonitorTest : public ::testing::Test {
 protected:
  void command(double linear_mps) {
    motion_.want_velocity({linear_mps, 0.0});
    monitor_.aim_at(motion_.aim(), motion_.limits(), now_ns_);
    monitor_.written(now_ns_);
  }
  /// A report a tenth of a second after the previous one.
  void report(double linear_mps, McpPhase phase) {
    McpReport report{.mask = settings_.report_mask};
    report.fields[static_cast<std::size_t>(McpField::kTranslateSpeed)] =
        static_cast<std::uint32_t>(units_.counts(linear_mps));
    report.fields[static_cast<std::size_t>(McpField::kTranslateStatus)] =
        static_cast<std::uint32_t>(phase) << 13U;
    now_ns_ += 100'000'000;
    report.fields[static_cast<std::size_t>(McpField::kClock)] =
        static_cast<std::uint32_t>(now_ns_ * kMcpTicksPerSecond / 1'000'000'000);
    monitor_.take(report, motion_, now_ns_, now_ns_);
  }

  BaseSettings settings_;
  McpUnits units_{settings_.calibration};
  BaseMotion motion_{units_, settings_.limits};
  MotionMonitor monitor_{units_, settings_};
  std::int64_t now_ns_ = 0;
};

TEST_F(MotionMonitorTest, SeesWhetherTheBaseStandsAndBrakes) {
  report(0.3, McpPhase::kDecelerate);
  EXPECT_FALSE(monitor_.stands());
  EXPECT_TRUE(monitor_.slows_down());
  report(0.0, McpPhase::kStop);
  report(0.0, McpPhase::kLimp);
  EXPECT_TRUE(monitor_.stands());
  EXPECT_TRUE(monitor_.limp());
  EXPECT_EQ(monitor_.reports_standing(), 2U);
}

TEST_F(MotionMonitorTest, AccelerationWithoutSpeedIsAStallWhenItLasts) {
  command(0.2);
  report(0.0, McpPhase::kAccelerate);
  report(0.0, McpPhase::kAccelerate);
  EXPECT_FALSE(monitor_.stalled());
  report(0.0, McpPhase::kAccelerate);
  EXPECT_TRUE(monitor_.stalled());
  command(0.0);
  EXPECT_FALSE(monitor_.stalled());
}

TEST_F(MotionMonitorTest, SlowMotionThatFollowsItsCommandsIsNoEmergencyStop) {
  for (const double speed_mps : {0.01, 0.02, 0.03}) {
    command(speed_mps);
    report(speed_mps / 3.0, McpPhase::kAccelerate);
  }
  EXPECT_FALSE(monitor_.stalled());
}

TEST_F(MotionMonitorTest, MotionWithoutACommandIsTheJoystickUntilItHasRestedForASecond) {
  report(0.3, McpPhase::kConstant);
  EXPECT_FALSE(monitor_.joystick()) << "a single report may be wrong";
  report(0.3, McpPhase::kConstant);
  EXPECT_TRUE(monitor_.joystick());
  for (int i = 0; i < 10; ++i) report(0.0, McpPhase::kStop);
  EXPECT_TRUE(monitor_.joystick());
  report(0.0, McpPhase::kStop);
  EXPECT_FALSE(monitor_.joystick());
}

TEST_F(MotionMonitorTest, ACommandThatHasNoEffectWasLost) {
  command(0.2);
  report(0.0, McpPhase::kStop);
  EXPECT_FALSE(monitor_.disobeys()) << "it may still begin";
  for (int i = 0; i < 15; ++i) report(0.0, McpPhase::kStop);
  EXPECT_TRUE(monitor_.disobeys());
  report(0.2, McpPhase::kConstant);
  EXPECT_FALSE(monitor_.disobeys());
  EXPECT_FALSE(monitor_.joystick());
}

}  // namespace
}  // namespace topogeo::devices
