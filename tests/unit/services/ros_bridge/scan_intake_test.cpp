#include "ros_bridge/scan_intake.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros_conversions/ros_messages.hpp"

namespace topogeo::ros_bridge {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

class ScanIntakeTest : public testing::Test {
 protected:
  explicit ScanIntakeTest(const IntakeOptions& options = options_of()) : intake_(options) {
    intake_.set_robot_frame("base_link");
    intake_.frames().put("base_link", "laser", ros::at(0.1, 0.0, 0.0));
  }
  static IntakeOptions options_of() {
    IntakeOptions options;
    options.T_robot_laser = {0.1, 0.0, 0.0};
    options.longest_extrapolation_ns = kSecond_ns / 2;
    return options;
  }
  void odometry(double time_s, double x_m) {
    intake_.add(geometry::OdometrySample{stamp(time_s), {x_m, 0.0, 0.0}, 1.0, 0.0});
  }
  void scan(double time_s, const std::string& frame = "laser") {
    intake_.add(ros::laser_scan(-0.1, 0.1, {1.0F, 2.0F, 3.0F}, stamp(time_s), frame), 0);
  }
  static std::int64_t stamp(double time_s) {
    return static_cast<std::int64_t>(time_s * static_cast<double>(kSecond_ns));
  }

  ScanIntake intake_;
};

TEST_F(ScanIntakeTest, GivesAScanTheOdometryOfItsTime) {
  odometry(10.0, 1.0);
  odometry(11.0, 2.0);
  scan(10.5);
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 1U);
  EXPECT_NEAR(leaving[0].scan.T_odom_robot.x_m, 1.5, 1e-9);
  EXPECT_EQ(leaving[0].scan.sequence, 0U);
  EXPECT_EQ(leaving[0].scan.stamp_ns, stamp(10.5));
}

class ScanIntakeWithoutOdometry : public ScanIntakeTest {
 protected:
  ScanIntakeWithoutOdometry() : ScanIntakeTest(without_odometry()) {}
  static IntakeOptions without_odometry() {
    IntakeOptions options = options_of();
    options.without_odometry = true;
    options.odometry_wait_ns = kSecond_ns;
    return options;
  }
};

TEST_F(ScanIntakeWithoutOdometry, PassesScansOnAtOnce) {
  scan(10.0);
  scan(10.1);
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 2U);
  EXPECT_EQ(leaving[1].scan.sequence, 1U);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kNoOdometry), 0U);
}

TEST_F(ScanIntakeWithoutOdometry, BeginsAnewWhereTheClockIsSetBack) {
  scan(10.0);
  ASSERT_EQ(intake_.take(0).size(), 1U);
  const std::uint64_t epochs = intake_.epochs();
  scan(2.0);
  scan(2.1);
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 2U);
  EXPECT_EQ(leaving[0].scan.sequence, 0U);
  EXPECT_EQ(leaving[0].scan.odometry_epoch, epochs + 1);
}

TEST_F(ScanIntakeTest, CarriesTheLastOdometryOnForAWhile) {
  odometry(10.0, 1.0);
  scan(10.2);
  scan(11.0);
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 1U);
  EXPECT_NEAR(leaving[0].scan.T_odom_robot.x_m, 1.2, 1e-9);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kNoOdometry), 1U);
}

TEST_F(ScanIntakeTest, CountsWhatItCannotUse) {
  scan(9.0);
  EXPECT_THAT(intake_.take(0), IsEmpty());
  EXPECT_EQ(intake_.dropped(IntakeDrop::kNoOdometry), 1U);
  odometry(10.0, 1.0);
  scan(10.0, "camera");
  intake_.take(0);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kNoMounting), 1U);
  EXPECT_THAT(intake_.detail(IntakeDrop::kNoMounting), HasSubstr("base_link to camera"));
  scan(10.1);
  scan(10.1);
  EXPECT_EQ(intake_.take(0).size(), 1U);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kOldScan), 1U);
  intake_.add(ros::laser_scan(0.0, 0.1, {}, stamp(10.2)), 0);
  intake_.take(0);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kInvalidScan), 1U);
  odometry(9.9, 1.0);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kOldOdometry), 1U);
}

TEST_F(ScanIntakeTest, ALaserElsewhereThanConfiguredIsRefusedWithTheFlagThatHelps) {
  intake_.frames().put("base_link", "front", ros::at(0.3, 0.0, 0.0));
  odometry(10.0, 0.0);
  scan(10.0, "front");
  EXPECT_THAT(intake_.take(0), IsEmpty());
  EXPECT_THAT(intake_.detail(IntakeDrop::kOtherMounting), HasSubstr("--laser=0.3"));
}

TEST_F(ScanIntakeTest, AnotherHeadingOfTheLaserTurnsTheBeams) {
  intake_.frames().put("base_link", "turned", ros::at(0.1, 0.0, 0.5));
  odometry(10.0, 0.0);
  scan(10.0, "turned");
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 1U);
  EXPECT_NEAR(leaving[0].scan.angle_min_rad, 0.4, 1e-6);
}

TEST_F(ScanIntakeTest, AScanWithOneBeamMoreHasTheBeamsOfTheFirst) {
  odometry(10.0, 0.0);
  scan(10.0);
  intake_.add(ros::laser_scan(-0.1, 0.1, {1.5F, 2.5F, 3.5F, 4.5F}, stamp(10.1)), 0);
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 2U);
  EXPECT_THAT(leaving[1].scan.ranges_m, testing::ElementsAre(1.5F, 2.5F, 3.5F));
  EXPECT_EQ(intake_.adapted(), 1U);
}

TEST_F(ScanIntakeTest, AScanOfOtherBeamsIsRefused) {
  odometry(10.0, 0.0);
  scan(10.0);
  intake_.add(ros::laser_scan(2.0, 0.1, {1.5F, 2.5F, 3.5F}, stamp(10.1)), 0);
  EXPECT_EQ(intake_.take(0).size(), 1U);
  EXPECT_EQ(intake_.dropped(IntakeDrop::kOtherBeams), 1U);
  EXPECT_THAT(intake_.detail(IntakeDrop::kOtherBeams), HasSubstr("the first scan had 3 beams"));
}

TEST_F(ScanIntakeTest, TheRangeThatMeansNoEchoIsFoundOnTheWay) {
  constexpr float kNoEcho_m = 8.187F;
  std::vector<std::size_t> without_echo;
  for (int i = 0; i < 40; ++i) {
    const double time_s = 10.0 + 0.1 * i;
    odometry(time_s, 0.25 * i);
    std::vector<float> ranges_m;
    ranges_m.reserve(10);
    for (int beam = 0; beam < 10; ++beam) {
      ranges_m.push_back(
          beam < 3 ? kNoEcho_m : 1.0F + std::fmod(0.37F * static_cast<float>(7 * i + beam), 6.0F));
    }
    intake_.add(ros::laser_scan(-0.5, 0.1, ranges_m, stamp(time_s)), 0);
    for (const ScanIntake::Leaving& leaving : intake_.take(0)) {
      without_echo.push_back(static_cast<std::size_t>(
          std::ranges::count(leaving.scan.ranges_m, scan::Scan::kNoReturn)));
    }
  }
  ASSERT_EQ(without_echo.size(), 40U);
  EXPECT_EQ(without_echo[28], 0U);
  EXPECT_EQ(without_echo[29], 3U) << "30 places";
  EXPECT_EQ(without_echo.back(), 3U);
  ASSERT_TRUE(intake_.no_return());
  EXPECT_NEAR(intake_.no_return()->range_m, kNoEcho_m, 1e-6);
}

TEST_F(ScanIntakeTest, TimeThatGoesBackBeginsAnotherEpoch) {
  odometry(100.0, 1.0);
  scan(100.0);
  ASSERT_EQ(intake_.take(0).size(), 1U);
  const std::uint64_t epoch = intake_.epochs();
  EXPECT_THAT(intake_.add(geometry::OdometrySample{stamp(10.0), {}, 0.0, 0.0}),
              HasSubstr("time went back"));
  scan(10.0);
  const auto leaving = intake_.take(0);
  ASSERT_EQ(leaving.size(), 1U);
  EXPECT_EQ(leaving[0].scan.sequence, 0U);
  EXPECT_EQ(leaving[0].scan.odometry_epoch, epoch + 1);
}

TEST_F(ScanIntakeTest, AResetToZeroNearByBeginsAnotherEpoch) {
  odometry(10.0, 0.4);
  EXPECT_THAT(intake_.add(geometry::OdometrySample{stamp(10.05), {}, 0.0, 0.0}),
              HasSubstr("jumped"));
}

TEST_F(ScanIntakeTest, AJumpOfTheOdometryBeginsAnotherEpoch) {
  odometry(10.0, 1.0);
  EXPECT_THAT(intake_.add(geometry::OdometrySample{stamp(10.1), {20.0, 0.0, 0.0}, 0.0, 0.0}),
              HasSubstr("jumped"));
  EXPECT_THAT(intake_.add(geometry::OdometrySample{stamp(10.2), {20.1, 0.0, 0.0}, 0.0, 0.0}),
              IsEmpty());
}

class WaitingIntakeTest : public ScanIntakeTest {
 protected:
  WaitingIntakeTest() : ScanIntakeTest(options()) {}
  static IntakeOptions options() {
    IntakeOptions options = options_of();
    options.odometry_wait_ns = 1000;
    return options;
  }
};

TEST_F(WaitingIntakeTest, WaitsForTheOdometryAfterTheScanButNotForEver) {
  odometry(10.0, 1.0);
  scan(10.1);
  EXPECT_THAT(intake_.take(10), IsEmpty());
  EXPECT_EQ(intake_.due_ns(), 1000);
  EXPECT_EQ(intake_.take(1000).size(), 1U);
  scan(10.2);
  odometry(10.3, 1.3);
  EXPECT_EQ(intake_.take(0).size(), 1U);
}

}  // namespace
}  // namespace topogeo::ros_bridge
