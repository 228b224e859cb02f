#include "topogeo/fitness/fitness_printed.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

// A straight branch with points at quarters of its length.
BranchCurve curve(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                  double clearance_m = 1.0) {
  BranchCurve branch;
  for (int i = 0; i <= 4; ++i) branch.points_m.emplace_back(from + (to - from) * i / 4.0);
  branch.clearance_m = clearance_m;
  return branch;
}

MatchFeatures branches(std::vector<BranchCurve> curves) {
  MatchFeatures features;
  features.curves = std::move(curves);
  return features;
}

double fitness_of(const MatchFeatures& reference, const MatchFeatures& query, const Pose2& T = {}) {
  const Reference made = make_reference(reference);
  return PrintedFitness(made, query)(T);
}

// 6.30 with n = 1, m = 0: 1 / (0.5 + 1).
TEST(PrintedFitnessTest, OneNodeByItsDistance) {
  MatchFeatures reference;
  reference.nodes = {test::node(1.3, 1.4, 0.8), test::node(1.0, 1.0, 1.2)};  // the nearer is wider
  MatchFeatures query;
  query.nodes = {test::node(1.0, 1.0, 0.8)};
  EXPECT_NEAR(fitness_of(reference, query), 1.0 / 1.5, 1e-12);
  EXPECT_NEAR(fitness_of(reference, query, {0.3, 0.4, 0.0}), 1.0, 1e-12);
}

// The reference runs up the y axis from 0 to 4, with points at whole metres. The query runs from
// (0.3, 1) to (-0.3, 3). Its ends project on the reference at (0, 1) and (0, 3), 0.3 m away; the
// reference's ends project beyond it. 6.35: sqrt(0.3^2 + 0.3^2) / 2 = 0.212132. 6.36: angles
// pi / 2 and pi - atan(2 / 0.6) = 1.862253, factor 0.291457 / 3.433049 = 0.084898. 6.37: 0.018009.
constexpr double kCrossing_m = 0.018009;

MatchFeatures upright() {
  return branches({curve({0, 0}, {0, 4})});
}
MatchFeatures crossing() {
  return branches({curve({0.3, 1}, {-0.3, 3})});
}

TEST(PrintedFitnessTest, OneBranchByHand) {
  EXPECT_NEAR(fitness_of(upright(), crossing()), 1.0 / (1.0 + kCrossing_m), 1e-6);
  EXPECT_NEAR(fitness_of(crossing(), upright()), 1.0 / (1.0 + kCrossing_m), 1e-6);
  // The order of a branch's ends does not matter.
  EXPECT_NEAR(fitness_of(branches({curve({0, 4}, {0, 0})}), crossing()), 1.0 / (1.0 + kCrossing_m),
              1e-6);
  // The frame of the query map does not matter either.
  const Pose2 T{0.7, -1.1, 0.4};
  const Pose2 back = geometry::inverse(T);
  const MatchFeatures moved =
      branches({curve(back * Eigen::Vector2d(0.3, 1), back * Eigen::Vector2d(-0.3, 3))});
  EXPECT_NEAR(fitness_of(upright(), moved, T), 1.0 / (1.0 + kCrossing_m), 1e-6);
}

// The branch from (0.3, 0) to (0.5, 4): its first end projects, 0.3 m away, and of the upper ends,
// which both project, the nearer counts: 0.5 m (proposition 6.2.3). 6.35: sqrt(0.09 + 0.25) / 2 =
// 0.291548; angles pi / 2 and atan(4 / 0.2) = 1.520838, factor 0.049958 / 3.091634 = 0.016159.
TEST(PrintedFitnessTest, OfTwoEndsBesideEachOtherTheNearerCounts) {
  EXPECT_NEAR(fitness_of(upright(), branches({curve({0.3, 0}, {0.5, 4})})),
              1.0 / (1.0 + 0.291548 * 0.016159), 1e-6);
}

// 6.30 with n = 1, m = 1: the mean of 0.5 m and the distance above.
TEST(PrintedFitnessTest, NodesAndBranchesAreOneMean) {
  MatchFeatures reference = upright();
  reference.nodes = {test::node(2.3, 2.4, 0.8)};
  MatchFeatures query = crossing();
  query.nodes = {test::node(2.0, 2.0, 0.8)};
  EXPECT_NEAR(fitness_of(reference, query), 1.0 / (1.0 + (0.5 + kCrossing_m) / 2.0), 1e-6);
}

// One branch equivalent to two: its distance is the mean of both distances. The second reference is
// the query itself: 0.
TEST(PrintedFitnessTest, SeveralEquivalentBranchesAreAveraged) {
  MatchFeatures reference = upright();
  reference.curves.push_back(crossing().curves.front());
  EXPECT_NEAR(fitness_of(reference, crossing()), 1.0 / (1.0 + kCrossing_m / 2.0), 1e-6);
}

// Errors of the printed form, which the errata describe.
TEST(PrintedFitnessTest, AParallelBranchBesideScoresAsIfItLayOnIt) {
  EXPECT_DOUBLE_EQ(fitness_of(upright(), branches({curve({0.4, 0}, {0.4, 4})})), 1.0);
}

TEST(PrintedFitnessTest, WhatHasNoPartnerDoesNotCount) {
  MatchFeatures query = crossing();
  query.curves.push_back(curve({20, 0}, {20, 5}));
  query.nodes = {test::node(30, 30, 1.0)};
  EXPECT_NEAR(fitness_of(upright(), query), 1.0 / (1.0 + kCrossing_m), 1e-6);
}

TEST(PrintedFitnessTest, BranchesAlongXAreParallelInsteadOfNotANumber) {
  const MatchFeatures along = branches({curve({0, 0}, {4, 0})});
  EXPECT_DOUBLE_EQ(fitness_of(along, branches({curve({1, 0.2}, {3, 0.2})})), 1.0);
  EXPECT_DOUBLE_EQ(fitness_of(along, branches({curve({3, 0.2}, {1, 0.2})})), 1.0);
}

// Angles of 1 and 179 degrees: nearly parallel, and the factor is 178 / 180.
TEST(PrintedFitnessTest, TheSeamOfTheAngleCountsAsATurn) {
  const double half = 2.0 * std::tan(kDegree);
  const MatchFeatures rising = branches({curve({-2, -half}, {2, half})});
  const MatchFeatures falling = branches({curve({-1.9, half + 0.3}, {1.9, -half + 0.3})});
  const double parallel =
      fitness_of(rising, branches({curve({-1.9, -half + 0.3}, {1.9, 0.3 + half})}));
  EXPECT_GT(parallel, 0.99);
  EXPECT_LT(fitness_of(rising, falling), 0.9);
}

TEST(PrintedFitnessTest, EquivalentIsNearInPlaceInclinationAndClearance) {
  EXPECT_EQ(fitness_of(upright(), branches({curve({5, 0}, {5, 4})})), 0.0);
  EXPECT_EQ(fitness_of(upright(), branches({curve({0, 0}, {0, 4}, 1.4)})), 0.0);
  EXPECT_GT(fitness_of(upright(), branches({curve({0, 0}, {0, 4}, 1.2)})), 0.0);
  EXPECT_EQ(fitness_of(upright(), branches({curve({-1, 1}, {1, 3})})), 0.0);  // 45 degrees
  EXPECT_EQ(fitness_of(upright(), branches({curve({0, 6}, {0, 9})})), 0.0);   // beyond its end
  EXPECT_EQ(fitness_of({}, crossing()), 0.0);
  EXPECT_EQ(fitness_of(upright(), {}), 0.0);
}

TEST(PrintedFitnessTest, IsANumberFromZeroToOneAtEveryPoseOfARealMap) {
  const world::World floor = test::world("floor");
  const MatchFeatures query = extract_features(test::map_at(floor, {9.0, 1.2, 0.4}, 1));
  const MatchFeatures features = extract_features(test::map_at(floor, {8.6, 1.2, 0.1}, 0));
  ASSERT_FALSE(query.curves.empty());
  const Reference reference = make_reference(features);
  const PrintedFitness fitness(reference, query);
  for (int i = 0; i < 2000; ++i) {
    const Pose2 T{0.01 * (i % 37), 0.02 * (i % 23) - 0.2,
                  geometry::wrap_angle(2.0 * std::numbers::pi * i / 2000.0)};
    const double value = fitness(T);
    ASSERT_GE(value, 0.0);
    ASSERT_LE(value, 1.0);
  }
  EXPECT_GT(fitness({0.4, 0.0, 0.3}), 0.5);
}

}  // namespace
}  // namespace topogeo::localization
