#include "topogeo/geometry/odometry_screen.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::geometry {
namespace {

constexpr std::int64_t kStep_ns = 50'000'000;

/// A robot on an arc at 0.5 m/s, 20 readings a second, from (3, 2).
std::vector<OdometrySample> arc(int count) {
  std::vector<OdometrySample> samples;
  for (int i = 0; i < count; ++i) {
    const double turn = 0.005 * i;
    samples.push_back({i * kStep_ns,
                       Pose2{3.0 + 5.0 * std::sin(turn), 2.0 + 5.0 * (1.0 - std::cos(turn)), turn},
                       0.0, 0.0});
  }
  return samples;
}

struct Screened {
  std::vector<OdometryScreen::Reading> readings;
  OdometryScreen screen;
};

Screened screened(const std::vector<OdometrySample>& samples) {
  Screened result;
  const auto take = [&] {
    for (const auto& reading : result.screen.take()) result.readings.push_back(reading);
  };
  for (const OdometrySample& sample : samples) {
    result.screen.add(sample);
    take();
  }
  result.screen.finish();
  take();
  EXPECT_EQ(result.screen.decided(), samples.size());
  return result;
}

/// Expects that all readings but those of `cut` are returned, unchanged, in order.
void expect_all_but(const std::vector<std::uint64_t>& cut,
                    const std::vector<OdometrySample>& samples, const Screened& result) {
  ASSERT_EQ(result.readings.size() + cut.size(), samples.size());
  EXPECT_EQ(result.screen.cut(), cut.size());
  std::uint64_t number = 0;
  std::size_t next_cut = 0;
  for (const OdometryScreen::Reading& reading : result.readings) {
    while (next_cut < cut.size() && cut[next_cut] == number) {
      ++next_cut;
      ++number;
    }
    EXPECT_EQ(reading.number, number);
    EXPECT_EQ(reading.sample.stamp_ns, samples[number].stamp_ns);
    EXPECT_EQ(reading.sample.T_odom_robot, samples[number].T_odom_robot);
    ++number;
  }
}

TEST(OdometryScreen, SoundOdometryPassesUnchangedInOneEpoch) {
  const std::vector<OdometrySample> samples = arc(200);
  const Screened result = screened(samples);
  expect_all_but({}, samples, result);
  EXPECT_EQ(result.readings.back().epoch, 0U);
  EXPECT_TRUE(result.screen.notes().empty());
}

TEST(OdometryScreen, APoseIsReturnedAtOnceWhileNothingIsUnclear) {
  OdometryScreen screen;
  std::size_t returned = 0;
  for (const OdometrySample& sample : arc(60)) {
    screen.add(sample);
    returned += screen.take().size();
  }
  EXPECT_EQ(returned, 60U);
}

TEST(OdometryScreen, SinglePosesOfZerosAreCutOut) {
  std::vector<OdometrySample> samples = arc(300);
  for (const std::size_t i : {80U, 160U, 161U}) samples[i].T_odom_robot = {};
  const Screened result = screened(samples);
  expect_all_but({80, 160, 161}, samples, result);
  EXPECT_EQ(result.screen.epochs(), 1U);
  ASSERT_EQ(result.screen.notes().size(), 1U);
  EXPECT_NE(result.screen.notes()[0].find("3 odometry poses are left out"), std::string::npos);
}

TEST(OdometryScreen, ZerosNearTheOriginAreCutOutToo) {
  std::vector<OdometrySample> samples = arc(300);
  for (OdometrySample& sample : samples) {  // starts 0.3 m from the origin
    sample.T_odom_robot.x_m -= 2.7;
    sample.T_odom_robot.y_m -= 2.0;
  }
  samples[60].T_odom_robot = {};
  expect_all_but({60}, samples, screened(samples));
}

TEST(OdometryScreen, OutliersThatDoNotAgreeAreCutOut) {
  std::vector<OdometrySample> samples = arc(300);
  samples[100].T_odom_robot = {50.0, 0.0, 0.0};
  samples[101].T_odom_robot = {-70.0, 3.0, 1.0};
  samples[102].T_odom_robot = {50.1, 0.0, 0.0};
  expect_all_but({100, 101, 102}, samples, screened(samples));
}

TEST(OdometryScreen, GarbageAtTheStartIsCutOut) {
  std::vector<OdometrySample> samples = arc(300);
  for (std::size_t i = 0; i < 3; ++i) samples[i].T_odom_robot = {12345.6, -9876.5, 0.1};
  const Screened result = screened(samples);
  expect_all_but({0, 1, 2}, samples, result);
  EXPECT_EQ(result.readings.front().epoch, 0U);
}

TEST(OdometryScreen, ARestartAtZeroBeginsAnEpoch) {
  std::vector<OdometrySample> samples = arc(300);
  const Pose2 T_odom_restart = samples[150].T_odom_robot;
  for (std::size_t i = 150; i < samples.size(); ++i) {
    samples[i].T_odom_robot = between(T_odom_restart, samples[i].T_odom_robot);
  }
  const Screened result = screened(samples);
  expect_all_but({}, samples, result);
  EXPECT_EQ(result.readings[149].epoch, 0U);
  EXPECT_EQ(result.readings[150].epoch, 1U);
  EXPECT_EQ(result.readings.back().epoch, 1U);
  ASSERT_EQ(result.screen.notes().size(), 1U);
  EXPECT_NE(result.screen.notes()[0].find("restarts 7.5 s"), std::string::npos);
}

TEST(OdometryScreen, ARestartAtZeroIsSeenWhereTheRobotWasNear) {
  std::vector<OdometrySample> samples;  // straight on, restart 0.4 m from the origin
  samples.reserve(300);
  for (int i = 0; i < 300; ++i) {
    samples.push_back({i * kStep_ns, {0.01 * (i < 100 ? i - 59 : i - 100), 0.0, 0.0}, 0.0, 0.0});
  }
  const Screened result = screened(samples);
  expect_all_but({}, samples, result);
  EXPECT_EQ(result.readings.back().epoch, 1U);
}

TEST(OdometryScreen, TwoRestartsWithinASecondAreNoWayBack) {
  std::vector<OdometrySample> samples = arc(300);
  for (std::size_t i = 150; i < samples.size(); ++i) {
    const double x_m = 0.02 * static_cast<double>(i < 165 ? i - 150 : i - 165);
    samples[i].T_odom_robot = {x_m, 0.0, 0.0};
  }
  const Screened result = screened(samples);
  EXPECT_EQ(result.readings[149].epoch, 0U);
  EXPECT_EQ(result.readings.back().epoch, 1U) << "not the epoch of before the restarts";
  EXPECT_EQ(result.screen.cut(), 15U);
}

TEST(OdometryScreen, AHeadingThatFlipsBeginsAnEpoch) {
  std::vector<OdometrySample> samples = arc(300);
  for (std::size_t i = 150; i < samples.size(); ++i) {
    samples[i].T_odom_robot.theta_rad =
        wrap_angle(samples[i].T_odom_robot.theta_rad + std::numbers::pi);
  }
  EXPECT_EQ(screened(samples).readings.back().epoch, 1U);
}

TEST(OdometryScreen, AFastRobotWithJitteringStampsIsPossible) {
  std::vector<OdometrySample> samples;  // 2.4 m/s, 5 Hz, every fourth stamp 0.19 s late
  samples.reserve(100);
  for (int i = 0; i < 100; ++i) {
    samples.push_back(
        {i * 200'000'000LL + (i % 4 == 3 ? 190'000'000LL : 0), {0.48 * i, 0.0, 0.0}, 0.0, 0.0});
  }
  const Screened result = screened(samples);
  expect_all_but({}, samples, result);
  EXPECT_EQ(result.screen.epochs(), 1U);
}

TEST(OdometryScreen, StampsOfAnotherYearSayNothingAboutThePoses) {
  std::vector<OdometrySample> samples = arc(300);
  samples[100].stamp_ns += 30'000'000'000'000'000;
  for (std::size_t i = 200; i < samples.size(); ++i) samples[i].stamp_ns -= 5'000'000'000;
  expect_all_but({}, samples, screened(samples));
}

TEST(OdometryScreen, AFewPosesAloneAreAllReturned) {
  std::vector<OdometrySample> samples = arc(4);
  samples[1].T_odom_robot = {900.0, 0.0, 0.0};
  expect_all_but({}, samples, screened(samples));
}

TEST(OdometryScreen, ARestartShortBeforeTheEndIsKept) {
  std::vector<OdometrySample> samples = arc(300);
  for (std::size_t i = 295; i < samples.size(); ++i) samples[i].T_odom_robot = {};
  const Screened result = screened(samples);
  expect_all_but({}, samples, result);
  EXPECT_EQ(result.readings.back().epoch, 1U);
}

TEST(OdometryScreen, NothingGivesNothing) {
  EXPECT_TRUE(screened({}).readings.empty());
}

}  // namespace
}  // namespace topogeo::geometry
