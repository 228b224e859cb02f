#include "topogeo/fitness/fitness_weighted.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

MatchTask task_at_origin() {
  MatchTask task;
  task.covariance = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  return task;
}

MatchFeatures straight_branch() {
  MatchFeatures features;
  for (int i = 0; i < 20; ++i) features.branches.push_back(test::sample(0.2 * i, 0, 0, 1.0));
  return features;
}

TEST(WeightedFitnessTest, CountsElementsByTheirWeight) {
  MatchFeatures query = straight_branch();
  query.branches[0].weight = 0.2;
  query.branches.resize(2);
  MatchFeatures known = query;
  known.branches = {query.branches[1]};
  known.branches[0].position_m.x() = 0.2;
  query.branches[0].position_m.x() = 5.0;  // no partner there
  const Reference reference = make_reference(known);
  const WeightedFitness fitness(reference, query, task_at_origin());
  EXPECT_NEAR(fitness.of_maps({}, geometry::sincos(0.0)), 1.0 / 1.2, 1e-9);
}

// When branches are the evidence, the walls that they imply count as well.
TEST(WeightedFitnessTest, CountsWallsWhereBranchesAreTheEvidence) {
  MatchFeatures features = straight_branch();
  for (int i = 0; i < 20; ++i) {
    features.surface.push_back({{0.2 * i, 1.0}, {0.0, -1.0}, true});
    features.coarse.push_back(features.surface.back());
  }
  const Reference reference = make_reference(features);
  const geometry::SinCos ahead = geometry::sincos(0.0);
  MatchTask task = task_at_origin();
  task.evidence = MatchEvidence::kBranches;
  MatchFeatures query = features;
  EXPECT_NEAR(WeightedFitness(reference, query, task).of_maps({}, ahead), 1.0, 1e-6);
  for (SurfacePoint& wall : query.coarse) wall.position_m.y() = 4.0;  // no wall there
  EXPECT_NEAR(WeightedFitness(reference, query, task).of_maps({}, ahead), 0.3, 1e-6);
  task.evidence = MatchEvidence::kFitness;
  EXPECT_NEAR(WeightedFitness(reference, query, task).of_maps({}, ahead), 1.0, 1e-6);
  query = features;
  query.branches.clear();  // only walls, as when no branch is confirmed
  task.evidence = MatchEvidence::kBranches;
  EXPECT_NEAR(WeightedFitness(reference, query, task).of_maps({}, ahead), 1.0, 1e-6);
}

TEST(WeightedFitnessTest, FallsFasterThanTheTopologicalFormWithTheDistanceAcross) {
  const MatchFeatures features = straight_branch();
  const Reference reference = make_reference(features);
  const WeightedFitness fitness(reference, features, task_at_origin());
  const geometry::SinCos ahead = geometry::sincos(0.0);
  EXPECT_NEAR(fitness.of_maps({}, ahead), 1.0, 1e-9);
  const double quarter = 1.0 - 0.25;  // half of the reach of 0.4 m
  EXPECT_NEAR(fitness.of_maps({0, 0.2, 0}, ahead), quarter * quarter, 1e-9);
  EXPECT_NEAR(fitness.of_maps({0, 0.45, 0}, ahead), 0.0, 1e-9);
}

// Along a branch of constant clearance only odometry distinguishes the places.
TEST(WeightedFitnessTest, OdometryDecidesAlongABareCorridor) {
  MatchFeatures known = straight_branch();
  for (int i = -10; i < 0; ++i) known.branches.push_back(test::sample(0.2 * i, 0, 0, 1.0));
  for (int i = 20; i < 30; ++i) known.branches.push_back(test::sample(0.2 * i, 0, 0, 1.0));
  const Reference reference = make_reference(known);
  const geometry::SinCos ahead = geometry::sincos(0.0);
  const MatchFeatures query = straight_branch();
  const WeightedFitness bound(reference, query, task_at_origin());
  EXPECT_NEAR(bound.of_maps({1.0, 0, 0}, ahead), bound.of_maps({}, ahead), 1e-9);
  EXPECT_LT(bound({1.0, 0, 0}), 0.5 * bound({}));
}

// A change of the clearance distinguishes them.
TEST(WeightedFitnessTest, ClearanceDecidesTowardsADoor) {
  MatchFeatures features = straight_branch();
  for (BranchSample& sample : features.branches) {
    sample.clearance_m = 2.0 - 0.4 * sample.position_m.x();
    sample.slope = -0.4;
  }
  const Reference reference = make_reference(features);
  const WeightedFitness fitness(reference, features, task_at_origin());
  const geometry::SinCos ahead = geometry::sincos(0.0);
  EXPECT_LT(fitness.of_maps({0.4, 0, 0}, ahead), 0.6 * fitness.of_maps({}, ahead));
}

TEST(WeightedFitnessTest, IsZeroWithoutElements) {
  const Reference reference = make_reference(straight_branch());
  const MatchFeatures nothing;
  EXPECT_EQ(WeightedFitness(reference, nothing, task_at_origin())({}), 0.0);
}

}  // namespace
}  // namespace topogeo::localization
