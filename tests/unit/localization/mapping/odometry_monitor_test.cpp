#include "topogeo/matching/odometry_monitor.hpp"

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

Eigen::Matrix3d variances(double position_m2, double heading_rad2) {
  return Eigen::Vector3d(position_m2, position_m2, heading_rad2).asDiagonal();
}

const Eigen::Matrix3d kOdometry = variances(0.01, 0.0025);  // 10 cm, 2.9 degrees
const Eigen::Matrix3d kMatch = variances(1e-4, 1e-5);

// Steps of one metre with odometry errors of so many deviations.
OdometryMonitor watch(int steps, double times_position, double times_heading,
                      const Eigen::Matrix3d& match_covariance = kMatch) {
  support::Random random(3);
  OdometryMonitor monitor;
  for (int i = 0; i < steps; ++i) {
    const geometry::Pose2 truth{1.0, 0.0, 0.0};
    const geometry::Pose2 odometry{1.0 + times_position * 0.1 * random.normal(),
                                   times_position * 0.1 * random.normal(),
                                   times_heading * 0.05 * random.normal()};
    monitor.add({odometry, kOdometry}, {truth, match_covariance});
  }
  return monitor;
}

TEST(OdometryMonitorTest, StartsAsConfigured) {
  EXPECT_EQ(OdometryMonitor().translation_factor(), 1.0);
  EXPECT_EQ(OdometryMonitor().heading_factor(), 1.0);
  EXPECT_TRUE(OdometryMonitor().widened(kOdometry).isApprox(kOdometry));
}

TEST(OdometryMonitorTest, ExpectsLessWhereOdometryIsBetterThanConfigured) {
  const OdometryMonitor good = watch(400, 0.1, 0.1);
  EXPECT_EQ(good.widened(kOdometry), kOdometry);  // for weighting, the configuration is a floor
  EXPECT_LT(good.expected(kOdometry)(0, 0), 0.2 * kOdometry(0, 0));
  EXPECT_LT(good.expected(kOdometry)(2, 2), 0.2 * kOdometry(2, 2));
  EXPECT_GT(good.expected(kOdometry)(0, 0), 0.01 * kOdometry(0, 0));
  const OdometryMonitor bad = watch(400, 2.0, 2.0);
  EXPECT_GT(bad.expected(kOdometry)(0, 0), bad.widened(kOdometry)(0, 0));
}

TEST(OdometryMonitorTest, FindsThatOdometryIsTwiceAndThriceAsBad) {
  const OdometryMonitor monitor = watch(400, 2.0, 3.0);
  EXPECT_NEAR(monitor.translation_factor(), 4.0, 1.5);
  EXPECT_NEAR(monitor.heading_factor(), 9.0, 4.0);
  const Eigen::Matrix3d widened = monitor.widened(kOdometry);
  EXPECT_NEAR(widened(0, 0), monitor.translation_factor() * kOdometry(0, 0), 1e-12);
  EXPECT_NEAR(widened(2, 2), monitor.heading_factor() * kOdometry(2, 2), 1e-12);
}

TEST(OdometryMonitorTest, NeverNarrowerThanConfigured) {
  EXPECT_EQ(watch(400, 0.1, 0.1).translation_factor(), 1.0);
  EXPECT_EQ(watch(400, 0.1, 0.1).heading_factor(), 1.0);
}

TEST(OdometryMonitorTest, ForgetsABadStretch) {
  OdometryMonitor monitor = watch(100, 5.0, 5.0);
  ASSERT_GT(monitor.heading_factor(), 10.0);
  for (int i = 0; i < 200; ++i) monitor.add({{1, 0, 0}, kOdometry}, {{1, 0, 0}, kMatch});
  EXPECT_EQ(monitor.heading_factor(), 1.0);
}

TEST(OdometryMonitorTest, OneWrongMatchIsBounded) {
  OdometryMonitor monitor;
  monitor.add({{1, 0, 0}, kOdometry}, {{30, -20, 3}, kMatch});
  EXPECT_GT(monitor.heading_factor(), 1.0);
  EXPECT_LT(monitor.heading_factor(), 6.0);
  EXPECT_LT(monitor.translation_factor(), 6.0);
}

TEST(OdometryMonitorTest, AMatchThatKnowsLittleSaysLittle) {
  const Eigen::Matrix3d vague = variances(1.0, 1.0);
  EXPECT_LT(watch(20, 4.0, 4.0, vague).translation_factor(), 1.5);
}

TEST(OdometryMonitorTest, AStandingRobotSaysNothing) {
  OdometryMonitor monitor;
  for (int i = 0; i < 50; ++i) {
    monitor.add({{}, Eigen::Matrix3d::Zero()}, {{0.01, 0, 0.01}, kMatch});
  }
  EXPECT_EQ(monitor.translation_factor(), 1.0);
}

}  // namespace
}  // namespace topogeo::localization
