#include "odometry_steps.hpp"

#include <gtest/gtest.h>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

const Eigen::Matrix3d kConfiguredStep = Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
const Eigen::Matrix3d kMatchOfStep = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
const UncertainPose kMetre{Pose2{1.0, 0.0, 0.0}, kConfiguredStep};

// Steps of a metre that are longer than odometry by this factor.
OdometrySteps drive_metres(int steps, double factor) {
  OdometrySteps driven;
  driven.add_none();
  for (int i = 0; i < steps; ++i) {
    driven.add(kMetre);
    driven.learn({Pose2{factor, 0.0, 0.0}, kMatchOfStep});
  }
  return driven;
}

PoseGraphEdge match_of_stops(std::uint32_t from, std::uint32_t to, const Pose2& T_from_to) {
  return {from, to, EdgeKind::kRevisit, T_from_to, kMatchOfStep, kMatchOfStep};
}

TEST(OdometryStepsTest, LearnsAScaleAndGivesItToTheStepsBeforeItWasKnown) {
  OdometrySteps steps = drive_metres(400, 1.02);
  steps.add(kMetre);
  EXPECT_GT(steps.last().T_a_b.x_m, 1.015);  // the prior counts as forty steps
  EXPECT_LE(steps.last().T_a_b.x_m, 1.02);
  EXPECT_EQ(steps.edge().T_from_to.x_m, steps.last().T_a_b.x_m);
  EXPECT_EQ(steps.rescaled(1)->x_m, steps.last().T_a_b.x_m);
  EXPECT_FALSE(steps.rescaled(0).has_value());
}

TEST(OdometryStepsTest, AGapHasNothingOfWhatWasLearned) {
  OdometrySteps steps = drive_metres(400, 1.02);
  steps.add_gap(kMetre);
  EXPECT_EQ(steps.last().T_a_b.x_m, 1.0);
  EXPECT_TRUE(steps.edge().covariance.isApprox(kConfiguredStep, 0.02));  // invertible
  EXPECT_TRUE(steps.edge().calibrated.isApprox(kConfiguredStep, 0.02));
  EXPECT_LT(drive_metres(400, 1.02).edge().calibrated(0, 0), 0.9 * kConfiguredStep(0, 0));
  EXPECT_FALSE(steps.rescaled(401).has_value());
}

TEST(OdometryStepsTest, AllowsAMatchWhereTheStepsMayHaveBroughtTheRobot) {
  OdometrySteps steps;
  steps.add_none();
  for (int i = 0; i < 4; ++i) steps.add(kMetre);
  // Four steps with 0.1 m of lateral error each, and 0.05 rad that turn the later steps.
  EXPECT_TRUE(steps.allow(match_of_stops(0, 4, Pose2{4.2, 0.3, 0.1}), 4.0));
  EXPECT_FALSE(steps.allow(match_of_stops(0, 4, Pose2{4.0, 0.0, 1.57}), 4.0));
  EXPECT_FALSE(steps.allow(match_of_stops(0, 4, Pose2{2.0, 0.0, 0.0}), 4.0));
  EXPECT_FALSE(steps.allow(match_of_stops(3, 4, Pose2{1.25, 0.0, 0.0}), 4.0));
  EXPECT_TRUE(
      steps.allow(match_of_stops(3, 4, Pose2{1.25, 0.0, 0.0}), geometry::kMahalanobis2Of99Percent));
}

TEST(OdometryStepsTest, CountsMoreThanConfiguredWhereItWasRightAndNoMatchIs) {
  const OdometrySteps right = drive_metres(400, 1.0);
  EXPECT_TRUE(
      right.edge().covariance.isApprox(kConfiguredStep, 0.02));  // the configuration is a floor
  EXPECT_LT(right.edge_without_match().covariance(0, 0), kConfiguredStep(0, 0));
  const OdometrySteps wrong = drive_metres(5, 1.5);
  EXPECT_GT(wrong.edge_without_match().covariance(0, 0), kConfiguredStep(0, 0));
}

}  // namespace
}  // namespace topogeo::localization
