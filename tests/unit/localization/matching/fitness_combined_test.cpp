#include "fitness_combined.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr double kFloat = 1e-6;  // tolerance of single precision

MatchTask wide_task() {
  MatchTask task;
  task.covariance = Eigen::Matrix3d::Identity() * 100.0;
  return task;
}

TEST(CombinedFitnessTest, IsNearlyOneWhereAMapLiesOnItself) {
  const MatchFeatures features =
      extract_features(test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0));
  ASSERT_GT(features.branches.size(), 20U);
  const Reference reference = make_reference(features);
  const CombinedFitness fitness(reference, features, wide_task());
  for (const double value : {fitness({}), fitness.topological()({}), fitness.scan()({})}) {
    EXPECT_GT(value, 0.9);
    EXPECT_LE(value, 1.0);
  }
}

TEST(CombinedFitnessTest, FallsWithEveryOffset) {
  const MatchFeatures features =
      extract_features(test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0));
  const Reference reference = make_reference(features);
  const CombinedFitness combined(reference, features, wide_task());
  const std::vector<const Fitness*> forms{&combined, &combined.topological(), &combined.scan()};
  for (const Fitness* fitness : forms) {
    for (const Pose2& unit :
         {Pose2{1, 0, 0}, Pose2{0, 1, 0}, Pose2{-0.7, 0.7, 0}, Pose2{0, 0, 1}}) {
      double before = (*fitness)({});
      for (const double far : {0.15, 0.25, 0.4}) {
        const double value = (*fitness)({far * unit.x_m, far * unit.y_m, far * unit.theta_rad});
        EXPECT_LT(value, before) << unit.x_m << " " << unit.y_m << " " << unit.theta_rad;
        before = value;
      }
    }
  }
}

TEST(CombinedFitnessTest, NothingToCompareScoresZero) {
  const Reference nothing = make_reference({});
  const MatchFeatures room = test::features_at(test::l_room(), {});
  EXPECT_EQ(CombinedFitness(nothing, room, wide_task())({}), 0.0);
  const Reference reference = make_reference(room);
  const MatchFeatures empty;
  EXPECT_EQ(CombinedFitness(reference, empty, wide_task())({}), 0.0);
  EXPECT_EQ(CombinedFitness(reference, room, wide_task())({500.0, -500.0, 1.0}), 0.0);
}

// Points beside a row of posts: the kernel (1 - d^2 / 0.3^2)^2 of the distance, mean over all
// points.
TEST(ScanFitnessTest, ByHand) {
  MatchFeatures wall;
  for (int i = 0; i <= 8; ++i) wall.surface.push_back({{0.5 * i, 0.0}, {0.0, 1.0}, true});
  const Reference reference = make_reference(wall);
  MatchFeatures query;
  query.coarse = {
      {{1.0, 0.0}}, {{2.0, 0.15}, {0.0, 1.0}, true}, {{3.0, -0.15}}, {{1.5, 0.31}}, {{2.5, 5.0}}};
  const ScanFitness fitness(reference, query);
  EXPECT_NEAR(fitness({}), (1.0 + 2.0 * 0.75 * 0.75) / 5.0, kFloat);
  // 0.15 m up: distances 0.15, 0.3, 0, 0.46 and 5.15 m.
  EXPECT_NEAR(fitness({0.0, 0.15, 0.0}), (0.75 * 0.75 + 1.0) / 5.0, kFloat);
  EXPECT_NEAR(fitness({0.0, 0.0, std::numbers::pi / 2}), 0.0, kFloat);
  // The wall of the second point, seen from the other side, is another face.
  query.coarse[1].normal = {0.0, -1.0};
  EXPECT_NEAR(ScanFitness(reference, query)({}), (1.0 + 0.75 * 0.75) / 5.0, kFloat);
}

TEST(ScanFitnessTest, IsWhatAComparisonWithEveryPointGives) {
  const MatchFeatures features = test::features_at(test::l_room(), {});
  const MatchFeatures query = test::features_at(test::l_room(), {0.3, 0.2, 0.2});
  const Reference reference = make_reference(features);
  const ScanFitness fitness(reference, query);
  ASSERT_GT(query.coarse.size(), 64U) << "more than one block";
  for (const Pose2& T : {Pose2{0.3, 0.2, 0.2}, Pose2{0.2, 0.3, 0.1}, Pose2{-0.2, -0.1, 0.4}}) {
    double sum = 0.0;
    for (const SurfacePoint& p : query.coarse) {
      double nearest2 = 0.09;
      for (const SurfacePoint& other : features.surface) {
        nearest2 = std::min(nearest2, (T * p.position_m - other.position_m).squaredNorm());
      }
      sum += (1.0 - nearest2 / 0.09) * (1.0 - nearest2 / 0.09);
    }
    // The grid may take the second-nearest point near the border of a cell.
    EXPECT_NEAR(fitness(T), sum / static_cast<double>(query.coarse.size()), 0.03);
  }
}

TEST(OdometryPriorTest, HalvesAtTwelveSquaredDeviations) {
  MatchTask task;
  task.T_reference_query = {1.0, 2.0, std::numbers::pi - 0.01};
  task.covariance.diagonal() << 0.04, 0.01, 0.0025;
  const OdometryPrior prior(task);
  EXPECT_DOUBLE_EQ(prior(task.T_reference_query), 1.0);
  EXPECT_NEAR(prior({1.0 + 0.2 * std::sqrt(12.0), 2.0, task.T_reference_query.theta_rad}), 0.5,
              1e-9);
  // Across the seam of the angle: 0.03 rad are 0.36 squared deviations.
  EXPECT_NEAR(prior({1.0, 2.0, -std::numbers::pi + 0.02}), 1.0 / (1.0 + 0.36 / 12.0), 1e-9);
}

TEST(CombinedFitnessTest, WithoutBranchesTheScanDecidesAlone) {
  const MatchFeatures room = test::features_at(test::l_room(), {});
  const Reference reference = make_reference(room);
  MatchTask task = wide_task();
  task.covariance = Eigen::Matrix3d::Identity() * 0.01;
  const CombinedFitness fitness(reference, room, task);
  const Pose2 pose{0.1, 0.05, 0.02};
  EXPECT_DOUBLE_EQ(fitness(pose), fitness.scan()(pose) * fitness.prior()(pose));
  EXPECT_LT(fitness.prior()(pose), 0.95);
}

TEST(CombinedFitnessTest, WeighsMapsAndScan) {
  const MatchFeatures features =
      extract_features(test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0));
  const Reference reference = make_reference(features);
  const CombinedFitness fitness(reference, features, wide_task());
  const Pose2 pose{0.1, 0.05, 0.02};
  EXPECT_NEAR(
      fitness(pose),
      (0.3 * fitness.topological()(pose) + 0.7 * fitness.scan()(pose)) * fitness.prior()(pose),
      1e-12);
}

// When a form is bound again, it forgets the previous maps.
TEST(CombinedFitnessTest, CanBeBoundAgain) {
  const world::World floor = test::world("floor");
  const MatchFeatures large = extract_features(test::map_at(floor, {8.6, 1.2, 0.1}, 0));
  const MatchFeatures small = test::features_at(test::l_room(), {}, {-40, 40, 1, 8});
  const Reference of_large = make_reference(large);
  const Reference of_small = make_reference(small);
  const MatchTask task = wide_task();
  CombinedFitness fitness(of_large, large, task);
  fitness.bind(of_small, small, task);
  const Pose2 pose{0.05, 0.0, 0.01};
  EXPECT_EQ(fitness(pose), CombinedFitness(of_small, small, task)(pose));
  fitness.bind(of_large, large, task);
  EXPECT_EQ(fitness(pose), CombinedFitness(of_large, large, task)(pose));
}

}  // namespace
}  // namespace topogeo::localization
