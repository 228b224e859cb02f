#include "topogeo/localization/fitness.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hand_scenes.hpp"
#include "simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

MatchTask wide_task(FitnessForm form = FitnessForm::kCombined) {
  MatchTask task;
  task.covariance = Eigen::Matrix3d::Identity() * 100.0;
  task.fitness_form = form;
  return task;
}

TEST(FitnessTest, IsNearlyOneWhereAMapLiesOnItself) {
  const topomap::LocalMap map = test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0);
  const MatchFeatures features = extract_features(map);
  ASSERT_GT(features.branches.size(), 20U);
  const Reference reference = make_reference(features);
  const Fitness fitness(reference, features, wide_task());
  for (const double value : {fitness({}), fitness.topological({}), fitness.scan({})}) {
    EXPECT_GT(value, 0.9);
    EXPECT_LE(value, 1.0);
  }
}

TEST(FitnessTest, FallsWithEveryOffset) {
  const topomap::LocalMap map = test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0);
  const MatchFeatures features = extract_features(map);
  const Reference reference = make_reference(features);
  for (const FitnessForm form : {FitnessForm::kTopological, FitnessForm::kCombined}) {
    const Fitness fitness(reference, features, wide_task(form));
    for (const Pose2& unit :
         {Pose2{1, 0, 0}, Pose2{0, 1, 0}, Pose2{-0.7, 0.7, 0}, Pose2{0, 0, 1}}) {
      double before = fitness({});
      for (const double far : {0.15, 0.25, 0.4}) {
        const double value = fitness({far * unit.x_m, far * unit.y_m, far * unit.theta_rad});
        EXPECT_LT(value, before) << unit.x_m << " " << unit.y_m << " " << unit.theta_rad;
        before = value;
      }
    }
  }
}

TEST(FitnessTest, DirectionOfBranchesCountsWithoutSign) {
  MatchFeatures features;
  features.branches = {test::sample(0, 0, 0.3, 1.0)};
  const Reference reference = make_reference(features);
  const Fitness fitness(reference, features, wide_task(FitnessForm::kTopological));
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, 90.0, 135.0, 180.0}) {
    const double turn_rad = degrees * test::kDegree;
    const double aligned = std::cos(turn_rad) * std::cos(turn_rad);
    EXPECT_NEAR(fitness({0, 0, turn_rad}), aligned, 1e-9) << degrees;
    EXPECT_NEAR(fitness({0, 0, -turn_rad}), aligned, 1e-9) << degrees;
  }
}

// A parallel branch beside the other one must not score like one that lies on it, which it does
// with the orientation factor as printed in 6.36.
TEST(FitnessTest, AParallelBranchBesideScoresByItsDistance) {
  MatchFeatures features;
  for (int i = 0; i < 20; ++i) features.branches.push_back(test::sample(0.2 * i, 0, 0, 1.0));
  const Reference reference = make_reference(features);
  const Fitness fitness(reference, features, wide_task(FitnessForm::kTopological));
  EXPECT_NEAR(fitness({0, 0.0, 0}), 1.0, 1e-9);
  const double quarter = 1.0 - 0.25;  // kernel (1 - d^2 / r^2)^2 at half of its reach of 0.6 m
  EXPECT_NEAR(fitness({0, 0.3, 0}), quarter * quarter, 1e-9);
  EXPECT_NEAR(fitness({0, 0.65, 0}), 0.0, 1e-9);
}

TEST(FitnessTest, AnElementWithoutPartnerCountsAgainstThePose) {
  MatchFeatures both;
  both.branches = {test::sample(0, 0, 0, 1.0), test::sample(5, 0, 0, 1.0)};
  MatchFeatures one;
  one.branches = {both.branches[0]};
  const Reference all = make_reference(both);
  const Reference half = make_reference(one);
  const MatchTask task = wide_task(FitnessForm::kTopological);
  EXPECT_NEAR(Fitness(all, both, task)({}), 1.0, 1e-9);
  EXPECT_NEAR(Fitness(half, both, task)({}), 0.5, 1e-9);
  // What the reference has beside is no fault: the query may have seen less.
  EXPECT_NEAR(Fitness(all, one, task)({}), 1.0, 1e-9);
}

TEST(FitnessTest, ClearanceMustAgreeToo) {
  MatchFeatures narrow;
  narrow.branches = {test::sample(0, 0, 0, 0.6)};
  MatchFeatures wide;
  wide.branches = {test::sample(0, 0, 0, 0.75)};
  MatchFeatures hall;
  hall.branches = {test::sample(0, 0, 0, 2.0)};
  const Reference reference = make_reference(narrow);
  const MatchTask task = wide_task(FitnessForm::kTopological);
  EXPECT_NEAR(Fitness(reference, wide, task)({}), 0.75 * 0.75, 1e-9);
  EXPECT_EQ(Fitness(reference, hall, task)({}), 0.0);
}

TEST(FitnessTest, ANodeWeighsThreeSamples) {
  MatchFeatures query;
  query.nodes = {test::node(1, 1, 0.8)};
  query.branches = {test::sample(4, 0, 0, 1.0)};
  MatchFeatures reference_features;
  reference_features.nodes = {test::node(1, 1, 0.8), test::node(1.2, 1, 3.0)};
  const Reference reference = make_reference(reference_features);
  const Fitness fitness(reference, query, wide_task(FitnessForm::kTopological));
  EXPECT_NEAR(fitness({}), 0.75, 1e-9);
  EXPECT_NEAR(fitness({-10, 0, 0}), 0.0, 1e-9);
}

TEST(FitnessTest, NothingToCompareScoresZero) {
  const Reference nothing = make_reference({});
  const MatchFeatures room = test::features_at(test::l_room(), {});
  EXPECT_EQ(Fitness(nothing, room, wide_task())({}), 0.0);
  const Reference reference = make_reference(room);
  const MatchFeatures empty;
  EXPECT_EQ(Fitness(reference, empty, wide_task())({}), 0.0);
}

TEST(FitnessTest, ThePriorHalvesAtTwelveSquaredDeviations) {
  MatchTask task;
  task.T_reference_query = {1.0, 2.0, std::numbers::pi - 0.01};
  task.covariance.diagonal() << 0.04, 0.01, 0.0025;
  const MatchFeatures none;
  const Reference reference = make_reference({});
  const Fitness fitness(reference, none, task);
  EXPECT_DOUBLE_EQ(fitness.prior(task.T_reference_query), 1.0);
  EXPECT_NEAR(fitness.prior({1.0 + 0.2 * std::sqrt(12.0), 2.0, task.T_reference_query.theta_rad}),
              0.5, 1e-9);
  // Across the seam of the angle: 0.03 rad are 0.36 squared deviations.
  EXPECT_NEAR(fitness.prior({1.0, 2.0, -std::numbers::pi + 0.02}), 1.0 / (1.0 + 0.36 / 12.0), 1e-9);
}

TEST(FitnessTest, WithoutBranchesTheScanDecidesAlone) {
  const MatchFeatures room = test::features_at(test::l_room(), {});
  const Reference reference = make_reference(room);
  MatchTask task = wide_task();
  task.covariance = Eigen::Matrix3d::Identity() * 0.01;
  const Fitness fitness(reference, room, task);
  const Pose2 pose{0.1, 0.05, 0.02};
  EXPECT_DOUBLE_EQ(fitness(pose), fitness.scan(pose) * fitness.prior(pose));
  EXPECT_LT(fitness.prior(pose), 0.95);
}

}  // namespace
}  // namespace topogeo::localization
