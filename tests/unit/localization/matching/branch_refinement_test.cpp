// Nodes and branches by hand: a corridor along x with a branch through a door across it.
#include "topogeo/localization/matching/branch_refinement.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr double kHalfPi = 1.5707963267948966;

// What a robot at T_world_robot sees of the corridor and the branch at x = 3.
MatchFeatures junction_from(const Pose2& T_world_robot) {
  const Pose2 T_robot_world = geometry::inverse(T_world_robot);
  MatchFeatures features;
  const auto add = [&](double x, double y, double direction, double clearance) {
    const Eigen::Vector2d p = T_robot_world * Eigen::Vector2d(x, y);
    features.branches.push_back(
        test::sample(p.x(), p.y(), direction + T_robot_world.theta_rad, clearance));
  };
  for (int i = 0; i <= 30; ++i) add(0.2 * i, 0.0, 0.0, 1.0);
  for (int i = 3; i <= 15; ++i) add(3.0, 0.2 * i, kHalfPi, 0.6);
  return features;
}

PosePrior weak_around(const Pose2& T) {
  return {T, Eigen::Matrix3d::Identity() * 1e-3};
}

TEST(BranchRefinementTest, FindsTheWholePoseWhereBranchesCross) {
  const Pose2 T_true{0.4, -0.1, 0.08};
  const Reference reference = make_reference(junction_from({}));
  const MatchFeatures query = junction_from(T_true);
  for (const Pose2& off : {Pose2{0.12, 0.1, 0.05}, Pose2{-0.15, 0.05, -0.06}, Pose2{0, -0.2, 0}}) {
    const Pose2 guess{T_true.x_m + off.x_m, T_true.y_m + off.y_m, T_true.theta_rad + off.theta_rad};
    const Alignment found = align_branches(reference, query, guess, weak_around(guess));
    EXPECT_TRUE(found.converged);
    EXPECT_NEAR(found.T_reference_query.x_m, T_true.x_m, 0.005);
    EXPECT_NEAR(found.T_reference_query.y_m, T_true.y_m, 0.005);
    EXPECT_NEAR(found.T_reference_query.theta_rad, T_true.theta_rad, 0.002);
  }
}

// Heading and the place across from the branch, the place along it from odometry.
TEST(BranchRefinementTest, LeavesThePlaceAlongOneBranchToThePrior) {
  MatchFeatures corridor;
  for (int i = 0; i <= 40; ++i) corridor.branches.push_back(test::sample(0.2 * i, 0, 0, 1.0));
  MatchFeatures query;
  for (int i = 10; i <= 30; ++i) query.branches.push_back(test::sample(0.2 * i, 0.15, 0, 1.0));
  const Reference reference = make_reference(corridor);
  const Pose2 predicted{0.33, 0.0, 0.03};
  const PosePrior prior{predicted, Eigen::Vector3d(10, 10, 10).asDiagonal()};
  const Alignment found = align_branches(reference, query, predicted, prior);
  EXPECT_NEAR(found.T_reference_query.x_m, 0.33, 0.02);
  EXPECT_NEAR(found.T_reference_query.y_m, -0.15, 0.01);
  EXPECT_NEAR(found.T_reference_query.theta_rad, 0.0, 0.005);
  const Eigen::Matrix3d known = branch_information_at(reference, query, found.T_reference_query);
  EXPECT_GT(known(1, 1), 1000.0 * (known(0, 0) + 1e-9));
}

// A corridor that widens: the clearance tells the place along it.
TEST(BranchRefinementTest, FindsThePlaceAlongABranchWhoseClearanceChanges) {
  const auto funnel = [](double from_m) {
    MatchFeatures features;
    for (int i = 0; i <= 30; ++i) {
      BranchSample sample = test::sample(0.2 * i, 0, 0, 0.8 + 0.3 * (0.2 * i + from_m));
      sample.slope = 0.3;
      features.branches.push_back(sample);
    }
    return features;
  };
  const Reference reference = make_reference(funnel(0.0));
  const MatchFeatures query = funnel(0.4);
  const Pose2 guess{0.2, 0.05, 0.02};
  const Alignment found = align_branches(reference, query, guess, weak_around(guess));
  EXPECT_NEAR(found.T_reference_query.x_m, 0.4, 0.02);
}

TEST(BranchRefinementTest, CountsWhatFitsAndWhatContradicts) {
  const Reference reference = make_reference(junction_from({}));
  const PoseEvidence right = branch_evidence_at(reference, junction_from({}), {});
  EXPECT_NEAR(right.overlap, 1.0, 1e-9);
  EXPECT_NEAR(right.inliers, 1.0, 1e-9);
  EXPECT_NEAR(right.violations, 0.0, 1e-9);
  // A hall where the reference saw walls one metre away.
  MatchFeatures hall;
  for (int i = 0; i < 10; ++i) hall.branches.push_back(test::sample(0.2 * i, 0, 0, 2.5));
  const PoseEvidence wrong = branch_evidence_at(reference, hall, {});
  EXPECT_NEAR(wrong.inliers, 0.0, 1e-9);
  EXPECT_NEAR(wrong.violations, 1.0, 1e-9);
}

TEST(BranchRefinementTest, NothingComesOfTooFewElements) {
  MatchFeatures few;
  few.branches = {test::sample(0, 0, 0, 1.0), test::sample(0.2, 0, 0, 1.0)};
  const Reference reference = make_reference(few);
  const Pose2 guess{0.1, 0.0, 0.0};
  const Alignment found = align_branches(reference, few, guess, weak_around(guess));
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.T_reference_query, guess);
  EXPECT_TRUE(branch_information_at(reference, few, {}).isZero(0.0));
}

}  // namespace
}  // namespace topogeo::localization
