// The motors of the emulated base, with free wheels.
#include "topogeo/simulation/mcp_drive.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::simulation {
namespace {

using devices::McpCommand;
using devices::McpField;

constexpr std::int64_t kTick_ns = 10'000'000;

class McpDriveTest : public ::testing::Test {
 protected:
  void pass(double time_s) {
    for (double end_s = time_s - 1e-9; end_s > 0.0; end_s -= 0.01) {
      now_ns_ += kTick_ns;
      const geometry::Velocity velocity = drive_.commanded_velocity();
      drive_.moved(0.01 * velocity.linear_m_per_s, 0.01 * velocity.angular_rad_per_s, 0.01);
      drive_.advance(now_ns_);
    }
  }

  McpDrive drive_{devices::McpCalibration{}};
  std::int64_t now_ns_ = 0;
};

TEST_F(McpDriveTest, StandsUntilAnOrderMovesIt) {
  pass(1.0);
  EXPECT_FALSE(drive_.moves());
  EXPECT_EQ(drive_.T_start_robot(), geometry::Pose2{});
  EXPECT_TRUE(drive_.execute({McpCommand::kTranslatePlus}));
  EXPECT_TRUE(drive_.moves());
  pass(1.0);
  EXPECT_GT(drive_.T_start_robot().x_m, 0.05);
  drive_.halt();
  pass(2.0);
  EXPECT_FALSE(drive_.moves());
}

TEST_F(McpDriveTest, OrdersOfTheControllerAreNotItsOwn) {
  EXPECT_FALSE(drive_.execute({McpCommand::kClock}));
  EXPECT_FALSE(drive_.execute({McpCommand::kReportPeriod, 10}));
  EXPECT_FALSE(drive_.moves());
}

TEST_F(McpDriveTest, GoesTheOrderedCountsAndBack) {
  ASSERT_TRUE(drive_.execute({McpCommand::kTranslateForward, 5000}));
  pass(20.0);
  EXPECT_NEAR(drive_.translate_register(), 5000U, 20U);
  const double there_m = drive_.T_start_robot().x_m;
  EXPECT_GT(there_m, 0.0);
  ASSERT_TRUE(drive_.execute({McpCommand::kTranslateTo, 0}));
  pass(20.0);
  EXPECT_NEAR(drive_.T_start_robot().x_m, 0.0, 0.01 * there_m);
}

TEST_F(McpDriveTest, StandsWithoutPowerAndGoesOnWithIt) {
  drive_.set_power(false);
  ASSERT_TRUE(drive_.execute({McpCommand::kRotatePlus}));
  pass(1.0);
  EXPECT_EQ(drive_.commanded_velocity().angular_rad_per_s, 0.0);
  drive_.set_power(true);
  pass(1.0);
  EXPECT_NE(drive_.commanded_velocity().angular_rad_per_s, 0.0);
}

TEST_F(McpDriveTest, AFailedMotorStandsUntilItsNextOrder) {
  drive_.execute({McpCommand::kTranslatePlus});
  pass(1.0);
  drive_.fail();
  pass(2.0);
  EXPECT_EQ(drive_.commanded_velocity().linear_m_per_s, 0.0);
  drive_.execute({McpCommand::kTranslatePlus});
  pass(1.0);
  EXPECT_GT(drive_.commanded_velocity().linear_m_per_s, 0.0);
}

TEST_F(McpDriveTest, ReportsThePlaceThatItsEncodersCount) {
  drive_.moved(1.0, 0.0, 1.0);
  devices::McpReport report;
  report.mask = devices::mask_bit(McpField::kX) | devices::mask_bit(McpField::kY);
  drive_.fill(report);
  const std::uint16_t ahead = report.word(McpField::kY);
  EXPECT_EQ(report.word(McpField::kX), 0x8000);
  EXPECT_GT(ahead, 0x8000);
  EXPECT_EQ(report.word(McpField::kHeading), 0) << "not in the mask";
  drive_.reset();
  drive_.fill(report);
  EXPECT_EQ(report.word(McpField::kY), 0x8000);
  EXPECT_NEAR(drive_.T_start_robot().x_m, 1.0, 1e-12) << "the truth outlives the power";
}

}  // namespace
}  // namespace topogeo::simulation
