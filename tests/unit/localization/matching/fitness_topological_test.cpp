#include "fitness_topological.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr double kSinglePrecision = 1e-6;  // tolerance of single precision

TEST(TopologicalFitnessTest, DirectionOfBranchesCountsWithoutSign) {
  MatchFeatures features;
  features.branches = {test::sample(0, 0, 0.3, 1.0)};
  const Reference reference = make_reference(features);
  const TopologicalFitness fitness(reference, features);
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, 90.0, 135.0, 180.0}) {
    const double turn_rad = degrees * test::kDegree;
    const double aligned = std::cos(turn_rad) * std::cos(turn_rad);
    EXPECT_NEAR(fitness({0, 0, turn_rad}), aligned, kSinglePrecision) << degrees;
    EXPECT_NEAR(fitness({0, 0, -turn_rad}), aligned, kSinglePrecision) << degrees;
  }
}

// A parallel branch beside the other one must not score like one that lies on it. With the
// orientation factor as printed in 6.36 it does.
TEST(TopologicalFitnessTest, AParallelBranchBesideScoresByItsDistance) {
  MatchFeatures features;
  for (int i = 0; i < 20; ++i) features.branches.push_back(test::sample(0.2 * i, 0, 0, 1.0));
  const Reference reference = make_reference(features);
  const TopologicalFitness fitness(reference, features);
  EXPECT_NEAR(fitness({0, 0.0, 0}), 1.0, kSinglePrecision);
  const double quarter = 1.0 - 0.25;  // kernel (1 - d^2 / r^2)^2 at half of its reach of 0.6 m
  EXPECT_NEAR(fitness({0, 0.3, 0}), quarter * quarter, kSinglePrecision);
  EXPECT_NEAR(fitness({0, 0.65, 0}), 0.0, kSinglePrecision);
}

TEST(TopologicalFitnessTest, AnElementWithoutPartnerCountsAgainstThePose) {
  MatchFeatures both;
  both.branches = {test::sample(0, 0, 0, 1.0), test::sample(5, 0, 0, 1.0)};
  MatchFeatures one;
  one.branches = {both.branches[0]};
  const Reference all = make_reference(both);
  const Reference half = make_reference(one);
  EXPECT_NEAR(TopologicalFitness(all, both)({}), 1.0, kSinglePrecision);
  EXPECT_NEAR(TopologicalFitness(half, both)({}), 0.5, kSinglePrecision);
  // Additional branches of the reference do not count, because the query may have seen less.
  EXPECT_NEAR(TopologicalFitness(all, one)({}), 1.0, kSinglePrecision);
}

TEST(TopologicalFitnessTest, ClearanceMustAgreeToo) {
  MatchFeatures narrow;
  narrow.branches = {test::sample(0, 0, 0, 0.6)};
  MatchFeatures wide;
  wide.branches = {test::sample(0, 0, 0, 0.75)};
  MatchFeatures hall;
  hall.branches = {test::sample(0, 0, 0, 2.0)};
  const Reference reference = make_reference(narrow);
  EXPECT_NEAR(TopologicalFitness(reference, wide)({}), 0.75 * 0.75, kSinglePrecision);
  EXPECT_EQ(TopologicalFitness(reference, hall)({}), 0.0);
}

TEST(TopologicalFitnessTest, ANodeWeighsThreeSamples) {
  MatchFeatures query;
  query.nodes = {test::node(1, 1, 0.8)};
  query.branches = {test::sample(4, 0, 0, 1.0)};
  MatchFeatures reference_features;
  reference_features.nodes = {test::node(1, 1, 0.8), test::node(1.2, 1, 3.0)};
  const Reference reference = make_reference(reference_features);
  const TopologicalFitness fitness(reference, query);
  EXPECT_NEAR(fitness({}), 0.75, kSinglePrecision);
  EXPECT_NEAR(fitness({-10, 0, 0}), 0.0, kSinglePrecision);
}

// Brute force over all branches and samples with double precision, from the header's definition.
double by_hand(const MatchFeatures& reference, const MatchFeatures& query, const Pose2& T) {
  const auto kernel = [](double distance, double width) {
    const double u = 1.0 - std::min(1.0, distance * distance / (width * width));
    return u * u;
  };
  const Pose2 turn{0.0, 0.0, T.theta_rad};
  double sum = 0.0;
  for (const topomap::LocalNode& node : query.nodes) {
    double best = 0.0;
    for (const topomap::LocalNode& other : reference.nodes) {
      best = std::max(best, kernel((T * node.position_m - other.position_m).norm(), 0.6) *
                                kernel(node.clearance_m - other.clearance_m, 0.6));
    }
    sum += 3.0 * best;
  }
  for (const BranchSample& sample : query.branches) {
    const Eigen::Vector2d at = T * sample.position_m;
    const BranchSample* other = nullptr;
    for (const BranchSample& candidate : reference.branches) {
      if (other == nullptr ||
          (candidate.position_m - at).norm() < (other->position_m - at).norm()) {
        other = &candidate;
      }
    }
    const Eigen::Vector2d d = at - other->position_m;
    const double across = d.x() * other->direction.y() - d.y() * other->direction.x();
    const double beyond2 = std::max(0.0, d.squaredNorm() - across * across - 0.01);
    const double alignment = (turn * sample.direction).dot(other->direction);
    sum += kernel(std::sqrt(across * across + beyond2), 0.6) *
           kernel(sample.clearance_m - other->clearance_m, 0.3) * alignment * alignment;
  }
  return sum / (3.0 * static_cast<double>(query.nodes.size()) +
                static_cast<double>(query.branches.size()));
}

// The grid may take the other sample only near the middle between two.
TEST(TopologicalFitnessTest, IsWhatAPlainComparisonOfAllElementsGives) {
  const world::World floor = test::world("floor");
  const MatchFeatures query = extract_features(test::map_at(floor, {9.0, 1.2, 0.4}, 1));
  const MatchFeatures features = extract_features(test::map_at(floor, {8.6, 1.2, 0.1}, 0));
  const Reference reference = make_reference(features);
  const TopologicalFitness fitness(reference, query);
  for (const Pose2& T : {Pose2{0.4, 0, 0.3}, Pose2{0.2, 0.2, 0.1}, Pose2{0.7, -0.3, -0.4}}) {
    EXPECT_NEAR(fitness(T), by_hand(features, query, T), 0.02);
  }
  EXPECT_GT(fitness({0.4, 0, 0.3}), 0.5);
}

}  // namespace
}  // namespace topogeo::localization
