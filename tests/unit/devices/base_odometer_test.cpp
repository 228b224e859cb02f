// A device's clock mapped to ours, reports as one pose, and commands that are sent only when they
// change something.
#include "topogeo/devices/base_odometer.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/base_motion.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kOdometerMs_ns = 1'000'000;
constexpr std::int64_t kOdometerSecond_ns = 1'000'000'000;

TEST(DeviceClock, FindsTheLeastDelayAndNeverJumps) {
  DeviceClock clock(10 * kOdometerMs_ns);
  support::Random random(1);
  std::int64_t last_ns = 0;
  for (std::int64_t device_ns = 0; device_ns < 100 * kOdometerSecond_ns;
       device_ns += 100 * kOdometerMs_ns) {
    // The device is 3 s behind us and its clock slow by 100 ppm; messages take 10 to 60 ms.
    const std::int64_t true_ns = 3 * kOdometerSecond_ns + device_ns + device_ns / 10'000;
    const auto delay_ns = static_cast<std::int64_t>(random.below(50'000'000));
    const std::int64_t stamp_ns = clock.map(device_ns, true_ns + 10 * kOdometerMs_ns + delay_ns);
    if (device_ns > 10 * kOdometerSecond_ns) {
      EXPECT_NEAR(static_cast<double>(stamp_ns - true_ns), 0.0, 5e6) << device_ns;
      EXPECT_NEAR(static_cast<double>(stamp_ns - last_ns), 100e6, 2.1e6) << device_ns;
    }
    EXPECT_GT(stamp_ns, last_ns);
    EXPECT_LE(stamp_ns, true_ns + 10 * kOdometerMs_ns + delay_ns);
    last_ns = stamp_ns;
  }
}

TEST(DeviceClock, StaysOrderedWhenTheDeviceStartsAnew) {
  DeviceClock clock(0);
  EXPECT_EQ(clock.map(5 * kOdometerSecond_ns, 7 * kOdometerSecond_ns), 7 * kOdometerSecond_ns);
  clock.restart();
  EXPECT_EQ(clock.map(0, 7 * kOdometerSecond_ns), 7 * kOdometerSecond_ns + 1);
  EXPECT_EQ(clock.map(kOdometerSecond_ns, 8 * kOdometerSecond_ns), 8 * kOdometerSecond_ns);
}

/// A base at heading 0, `forward_m` ahead of its pose at power-on.
McpReport standing(std::uint32_t ticks, double forward_m) {
  const McpUnits units{McpCalibration{}};
  McpReport report{.mask = 0x000A0A7A};
  const auto set = [&](McpField field, std::uint32_t value) {
    report.fields[static_cast<std::size_t>(field)] = value;
  };
  set(McpField::kClock, ticks);
  set(McpField::kX, 0x8000);
  set(McpField::kY,
      0x8000 + static_cast<std::uint32_t>(std::lround(units.position_units(forward_m))));
  return report;
}

using Verdict = BaseOdometer::Verdict;

class BaseOdometerTest : public testing::Test {
 protected:
  BaseOdometer::Result take(std::uint32_t ticks, double forward_m, std::int64_t arrival_ns) {
    return odometer_.take(standing(ticks, forward_m), arrival_ns);
  }
  BaseOdometer odometer_{BaseSettings{}};
};

TEST_F(BaseOdometerTest, DropsOneReportThatJumpsAndKeepsThePose) {
  for (std::uint32_t i = 0; i < 30; ++i) {
    EXPECT_EQ(take(1000 + 32 * i, 1.0, std::int64_t{i} * 125 * kOdometerMs_ns).verdict,
              Verdict::kGood);
  }
  EXPECT_EQ(take(1960, 19.0, 3750 * kOdometerMs_ns).verdict, Verdict::kImplausible);
  const auto after = take(1992, 1.0, 3875 * kOdometerMs_ns);
  EXPECT_EQ(after.verdict, Verdict::kGood);
  EXPECT_NEAR(after.odometry.T_odom_robot.x_m, 0.0, 0.01);
}

/// A driver that is killed after 30 reports, 8 a second, and one that starts 2 s later.
class ResumedOdometerTest : public BaseOdometerTest {
 protected:
  ResumedOdometerTest() {
    for (std::uint32_t i = 0; i <= 30; ++i) {
      (void)take(1000 + 32 * i, 0.02 * i, std::int64_t{i} * 125 * kOdometerMs_ns);
    }
    next_.resume(*odometer_.state());
  }
  static constexpr std::int64_t kLast_ns = std::int64_t{30} * 125 * kOdometerMs_ns;
  BaseOdometer next_{BaseSettings{}};
};

TEST_F(ResumedOdometerTest, GoesOnWhereTheBaseHasCountedTo) {
  const auto result = next_.take(standing(1960 + 512, 1.1),
                                 kLast_ns + 2 * kOdometerSecond_ns + 60 * kOdometerMs_ns);
  EXPECT_EQ(result.verdict, Verdict::kGood);
  EXPECT_TRUE(next_.has_resumed());
  EXPECT_NEAR(result.odometry.T_odom_robot.x_m, 1.1, 0.01) << "driven on meanwhile";
  EXPECT_EQ(next_.take(standing(1960 + 544, 1.1), kLast_ns + 2185 * kOdometerMs_ns).verdict,
            Verdict::kGood);
}

TEST_F(ResumedOdometerTest, OneWrongReportDoesNotCostIt) {
  EXPECT_EQ(next_.take(standing(1960 + 512, 19.0), kLast_ns + 2 * kOdometerSecond_ns).verdict,
            Verdict::kImplausible);
  const auto result = next_.take(standing(1960 + 544, 0.7), kLast_ns + 2125 * kOdometerMs_ns);
  EXPECT_TRUE(next_.has_resumed());
  EXPECT_NEAR(result.odometry.T_odom_robot.x_m, 0.7, 0.01);
}

TEST_F(ResumedOdometerTest, BeginsAnewWithABaseThatWasSwitchedOffOrAnotherOne) {
  // Clock and registers from power-on; then a fitting clock with a position that is too far away.
  for (const auto& [ticks, forward_m] :
       std::vector<std::pair<std::uint32_t, double>>{{200, 0.0}, {1960 + 512, 12.0}}) {
    BaseOdometer other{BaseSettings{}};
    other.resume(*odometer_.state());
    EXPECT_EQ(other.take(standing(ticks, forward_m), kLast_ns + 2 * kOdometerSecond_ns).verdict,
              Verdict::kImplausible);
    const auto result =
        other.take(standing(ticks + 32, forward_m), kLast_ns + 2125 * kOdometerMs_ns);
    EXPECT_EQ(result.verdict, Verdict::kGood);
    EXPECT_FALSE(other.has_resumed());
    EXPECT_EQ(result.odometry.T_odom_robot, geometry::Pose2{});
  }
}

TEST_F(BaseOdometerTest, BelievesAPlaceThatStays) {
  for (std::uint32_t i = 0; i < 30; ++i)
    (void)take(1000 + 32 * i, 1.0, std::int64_t{i} * 125 * kOdometerMs_ns);
  std::vector<Verdict> verdicts;
  for (std::uint32_t i = 30; i < 34; ++i) {
    verdicts.push_back(take(1000 + 32 * i, 2.0, std::int64_t{i} * 125 * kOdometerMs_ns).verdict);
  }
  EXPECT_EQ(verdicts, (std::vector{Verdict::kImplausible, Verdict::kImplausible, Verdict::kGood,
                                   Verdict::kGood}));
}

TEST_F(BaseOdometerTest, DropsReportsOfTheSameTimeAndOfTheFuture) {
  for (std::uint32_t i = 0; i < 30; ++i)
    (void)take(1000 + 32 * i, 1.0, std::int64_t{i} * 125 * kOdometerMs_ns);
  EXPECT_EQ(take(1928, 1.0, 3750 * kOdometerMs_ns).verdict, Verdict::kImplausible);
  EXPECT_EQ(take(1960 + 64, 1.0, 3750 * kOdometerMs_ns).verdict, Verdict::kImplausible);
  EXPECT_EQ(take(1960, 1.0, 3750 * kOdometerMs_ns).verdict, Verdict::kGood);
}

TEST_F(BaseOdometerTest, ALineThatWasSlowForLongMovesNothing) {
  const auto at = [](std::uint32_t i, std::int64_t late_ns) {
    return std::int64_t{i} * 125 * kOdometerMs_ns + late_ns;
  };
  for (std::uint32_t i = 0; i < 200; ++i) {
    EXPECT_EQ(take(1000 + 32 * i, 1.0, at(i, 400 * kOdometerMs_ns)).verdict, Verdict::kGood);
  }
  std::vector<Verdict> verdicts;
  for (std::uint32_t i = 200; i < 204; ++i) {
    const auto result = take(1000 + 32 * i, 1.0, at(i, 0));
    verdicts.push_back(result.verdict);
    if (result.verdict == Verdict::kGood) {
      EXPECT_NEAR(result.odometry.T_odom_robot.x_m, 0.0, 1e-9);
      EXPECT_LE(result.odometry.stamp_ns, at(i, 0));
    }
  }
  EXPECT_EQ(verdicts, (std::vector{Verdict::kImplausible, Verdict::kImplausible, Verdict::kGood,
                                   Verdict::kGood}));
}

TEST_F(BaseOdometerTest, GoesOnFromWhereItWasWhenTheBaseStartsAnew) {
  (void)take(100'000, 2.0, kOdometerSecond_ns);
  (void)take(100'032, 2.5, 3 * kOdometerSecond_ns);  // after a pause
  EXPECT_EQ(take(512, 0.0, 5 * kOdometerSecond_ns).verdict, Verdict::kImplausible);
  const auto second = take(544, 0.0, 5 * kOdometerSecond_ns + 125 * kOdometerMs_ns);
  EXPECT_EQ(second.verdict, Verdict::kRestarted);
  const auto third = take(576, 0.01, 5 * kOdometerSecond_ns + 250 * kOdometerMs_ns);
  EXPECT_EQ(third.verdict, Verdict::kGood);
  EXPECT_GT(third.odometry.stamp_ns, second.odometry.stamp_ns);
  EXPECT_NEAR(third.odometry.T_odom_robot.x_m - second.odometry.T_odom_robot.x_m, 0.01, 0.005);
}

std::vector<McpOrder> all_of(BaseMotion& motion) {
  std::vector<McpOrder> orders;
  while (const auto order = motion.next()) orders.push_back(*order);
  return orders;
}

class BaseMotionTest : public testing::Test {
 protected:
  BaseMotion motion_{McpUnits{McpCalibration{}}, BaseLimits{}};
};

TEST_F(BaseMotionTest, SaysSettingsBeforeWhatTheyAreForAndNothingTwice) {
  motion_.want_velocity({0.1, -std::numbers::pi / 8});
  EXPECT_EQ(all_of(motion_), (std::vector<McpOrder>{{McpCommand::kTranslateAcceleration, 14060},
                                                    {McpCommand::kTranslateVelocity, 2812},
                                                    {McpCommand::kTranslatePlus},
                                                    {McpCommand::kRotateAcceleration, 163},
                                                    {McpCommand::kRotateVelocity, 64},
                                                    {McpCommand::kRotatePlus}}));
  motion_.want_velocity({0.1, -std::numbers::pi / 8});
  EXPECT_TRUE(all_of(motion_).empty());
  motion_.want_velocity({-0.2, 0.0});
  EXPECT_EQ(all_of(motion_), (std::vector<McpOrder>{{McpCommand::kRotateHalt},
                                                    {McpCommand::kTranslateVelocity, 5624},
                                                    {McpCommand::kTranslateMinus}}));
  motion_.forget_run();
  EXPECT_EQ(all_of(motion_),
            (std::vector<McpOrder>{{McpCommand::kRotateHalt}, {McpCommand::kTranslateMinus}}));
}

TEST_F(BaseMotionTest, SendsARelativeMoveOnceAndTheSameAgainWhenItIsWantedAgain) {
  motion_.want_turn(std::numbers::pi / 2);
  const auto first = all_of(motion_);
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first.back(), (McpOrder{McpCommand::kRotateNegative, 256}));
  EXPECT_TRUE(motion_.relative_sent());
  EXPECT_TRUE(all_of(motion_).empty());
  motion_.want_turn(std::numbers::pi / 2);
  EXPECT_EQ(all_of(motion_), first.empty() ? first : std::vector{first.back()});
}

}  // namespace
}  // namespace topogeo::devices
