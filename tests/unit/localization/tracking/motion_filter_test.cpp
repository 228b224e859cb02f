#include "motion_filter.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

Eigen::Matrix3d variances(double x, double y, double theta) {
  return Eigen::Vector3d(x, y, theta).asDiagonal();
}

const Eigen::Matrix3d kExact = variances(1e-6, 1e-6, 1e-6);

double sigma_m(const UncertainPose& pose) {
  return std::sqrt(std::max(pose.covariance(0, 0), pose.covariance(1, 1)));
}

// An arc: 0.12 m and 9 degrees in each tenth of a second.
const Pose2 kStep{0.12, 0.01, 0.157};

TEST(MotionFilterTest, AnUnknownVelocityCoversAWalkAndATurn) {
  const UncertainPose step = MotionFilter().predict(1.0);
  EXPECT_EQ(step.T_a_b, Pose2{});
  EXPECT_GE(sigma_m(step), 0.7);  // 1.4 m/s within two deviations
  EXPECT_GE(std::sqrt(step.covariance(2, 2)), 0.8);
}

TEST(MotionFilterTest, AConstantMotionGoesOn) {
  MotionFilter motion;
  for (int i = 0; i < 20; ++i) motion.update(0.1, {kStep, kExact});
  const UncertainPose next = motion.predict(0.1);
  const Eigen::Vector3d off = geometry::difference(next.T_a_b, kStep);
  EXPECT_LT(off.head<2>().norm(), 0.01);
  EXPECT_LT(std::fabs(off.z()), 0.01);
  EXPECT_LT(sigma_m(next), 0.06);
  EXPECT_LT(std::sqrt(next.covariance(2, 2)), 0.08);
  // Twice the time, twice the arc.
  const Eigen::Vector3d off_two = geometry::difference(motion.predict(0.2).T_a_b, kStep * kStep);
  EXPECT_LT(off_two.head<2>().norm(), 0.02);
}

TEST(MotionFilterTest, ASuddenTurnIsWithinThreeDeviations) {
  MotionFilter motion;
  for (int i = 0; i < 50; ++i) motion.update(0.1, {{0.12, 0.0, 0.0}, kExact});
  const UncertainPose next = motion.predict(0.1);
  EXPECT_LT(0.157, 3.0 * std::sqrt(next.covariance(2, 2)));
}

TEST(MotionFilterTest, ADirectionThatTheScansDoNotMeasureStaysUncertain) {
  MotionFilter motion;
  for (int i = 0; i < 20; ++i) {
    motion.update(0.1, {{0.0, 0.0, 0.0}, variances(1e4, 1e-6, 1e-6)});
  }
  const UncertainPose next = motion.predict(0.1);
  EXPECT_GT(next.covariance(0, 0), 5.0 * next.covariance(1, 1));
}

TEST(MotionFilterTest, LearnsThatARobotIsSlow) {
  MotionFilter motion;
  const double before_m = sigma_m(motion.predict(3.0));
  for (int i = 0; i < 100; ++i) motion.update(3.0, {{0.9, 0.0, 0.0}, kExact});
  EXPECT_LT(sigma_m(motion.predict(3.0)), 0.6 * before_m);
}

}  // namespace
}  // namespace topogeo::localization
