#include "odometry_scale.hpp"

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

UncertainPose match_of(const Pose2& T, double sigma_along_m) {
  return {T, Eigen::Vector3d(sigma_along_m * sigma_along_m, 1e-4, 1e-5).asDiagonal()};
}

// Steps of a metre with odometry of this scale.
OdometryScale learned(int steps, double scale, double odometry_sigma_m, double match_sigma_m) {
  support::Random random(5);
  OdometryScale learned;
  for (int i = 0; i < steps; ++i) {
    learned.add({scale + odometry_sigma_m * random.normal(), 0.02 * random.normal(), 0.05},
                match_of({1.0 + match_sigma_m * random.normal(), 0.0, 0.0}, match_sigma_m));
  }
  return learned;
}

TEST(OdometryScaleTest, CorrectsNothingBeforeItKnows) {
  const OdometryScale scale;
  EXPECT_EQ(scale.factor(), 1.0);
  const Pose2 step{0.7, -0.1, 0.3};
  EXPECT_EQ(scaled(step, scale.factor()), step);
}

TEST(OdometryScaleTest, FindsWaysThatAreTooLongOrTooShort) {
  for (const double truth : {0.97, 1.02, 1.03}) {
    const OdometryScale scale = learned(1000, truth, 0.03, 0.02);
    EXPECT_NEAR(scale.factor() * truth, 1.0, 0.005) << truth;
    const Pose2 step = scaled({truth, 0.5 * truth, 0.1}, scale.factor());
    EXPECT_NEAR(step.x_m, 1.0, 0.005);
    EXPECT_NEAR(step.y_m, 0.5, 0.0025);
    EXPECT_EQ(step.theta_rad, 0.1);
  }
}

TEST(OdometryScaleTest, TheNoiseOfOdometryIsNoScale) {
  // A regression on odometry's distances would give 0.9936.
  EXPECT_NEAR(learned(2000, 1.0, 0.08, 0.02).factor(), 1.0, 0.004);
}

TEST(OdometryScaleTest, LearnsOnlyFromMatchesThatKnowTheWay) {
  EXPECT_EQ(learned(100, 1.03, 0.0, 0.05).factor(), 1.0);
  OdometryScale scale;
  const Pose2 metre{1.03, 0.0, 0.0};
  scale.add(metre, {{1.0, 0.0, 0.0}, Eigen::Vector3d(1.0, 1e-4, 1e-5).asDiagonal()});
  EXPECT_EQ(scale.factor(), 1.0) << "it knows only where across the corridor the robot is";
  scale.add({0.1, 0.0, 0.0}, match_of({0.097, 0.0, 0.0}, 0.02));
  EXPECT_EQ(scale.factor(), 1.0) << "hardly a step";
  scale.add({1.03, 0.0, 0.4}, match_of({1.0, 0.0, 0.4}, 0.02));
  EXPECT_EQ(scale.factor(), 1.0) << "a turn";
  scale.add({0.5, 0.0, 0.0}, match_of({1.0, 0.0, 0.0}, 0.02));
  EXPECT_EQ(scale.factor(), 1.0) << "a wheel that was held";
  scale.add(metre, match_of({1.0, 0.0, 0.0}, 0.02));
  EXPECT_LT(scale.factor(), 1.0);
}

TEST(OdometryScaleTest, TheWayCountsWhereverItLeads) {
  // The robot drives to its left; the match constrains only that direction.
  OdometryScale scale;
  for (int i = 0; i < 500; ++i) {
    scale.add({0.0, 1.02, 0.0}, {{0.3, 1.0, 0.0}, Eigen::Vector3d(1.0, 1e-4, 1e-5).asDiagonal()});
  }
  EXPECT_NEAR(scale.factor(), 1.0 / 1.02, 0.003);
}

TEST(OdometryScaleTest, FollowsAFloorThatChanges) {
  OdometryScale scale;
  for (int i = 0; i < 1000; ++i) scale.add({1.03, 0.0, 0.0}, match_of({1.0, 0.0, 0.0}, 0.02));
  for (int i = 0; i < 2500; ++i) scale.add({0.98, 0.0, 0.0}, match_of({1.0, 0.0, 0.0}, 0.02));
  EXPECT_NEAR(scale.factor(), 1.0 / 0.98, 0.003);
}

}  // namespace
}  // namespace topogeo::localization
