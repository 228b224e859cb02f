#include "topogeo/localization/genetic_search.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

TEST(GeneBitsTest, FollowTheFinestOfTheThreeIntervals) {
  MatchTask task;
  task.genetic.resolution_m = 0.15;
  task.genetic.resolution_rad = 2.0 * kDegree;
  task.half_width = {1.5, 1.5, 0.2};  // log2(2 * 1.5 / 0.15 + 1) = log2(21) = 4.4
  EXPECT_EQ(gene_bits(task), 5U);
  task.half_width = {0.5, 3.0, 0.2};  // log2(41) = 5.4
  EXPECT_EQ(gene_bits(task), 6U);
  task.half_width = {0.3, 0.3, 45.0 * kDegree};  // log2(90 / 2 + 1) = 5.5
  EXPECT_EQ(gene_bits(task), 6U);
  task.genetic.resolution_m = 0.25;
  task.half_width = {1.875, 0.1, 0.01};  // 15 steps: 16 values are 4 bits exactly
  EXPECT_EQ(gene_bits(task), 4U);
  task.half_width = {1.876, 0.1, 0.01};
  EXPECT_EQ(gene_bits(task), 5U);
}

TEST(GeneBitsTest, AreOneToTwentyFour) {
  MatchTask task;
  task.half_width = {0.01, 0.01, 0.001};
  EXPECT_EQ(gene_bits(task), 1U);
  task.half_width = {1.0, 1.0, 1.0};
  task.genetic.resolution_m = 1e-12;
  EXPECT_EQ(gene_bits(task), 24U);
}

// The l-shaped room from two places; the search starts with a prediction well off the truth.
class GeneticSearchTest : public testing::Test {
 protected:
  GeneticSearchTest()
      : reference_(make_reference(test::features_at(test::l_room(), {}))),
        query_(test::features_at(test::l_room(), kTruth)) {
    task_.T_reference_query = {};
    task_.covariance.diagonal() << 0.25, 0.25, 0.09;
    task_.half_width = {1.0, 1.0, 0.6};
    task_.genetic.individuals = 100;
    task_.genetic.generations = 50;
    task_.seed = 1;
  }

  SearchOutcome search() const { return genetic_search(task_, Fitness(reference_, query_, task_)); }

  static constexpr Pose2 kTruth{0.45, -0.35, 0.25};
  Reference reference_;
  MatchFeatures query_;
  MatchTask task_;
};

TEST_F(GeneticSearchTest, FindsTheKnownPoseFromAnySeed) {
  for (task_.seed = 1; task_.seed <= 10; ++task_.seed) {
    const SearchOutcome outcome = search();
    ASSERT_FALSE(outcome.solutions.empty());
    const Pose2& best = outcome.solutions.front().T_reference_query;
    EXPECT_LT(test::distance_m(best, kTruth), task_.genetic.resolution_m) << task_.seed;
    EXPECT_LT(test::turn_rad(best, kTruth), 1.5 * task_.genetic.resolution_rad) << task_.seed;
  }
}

TEST_F(GeneticSearchTest, DependsOnTheSeedAlone) {
  const SearchOutcome first = search();
  const SearchOutcome again = search();
  ASSERT_EQ(first.solutions.size(), again.solutions.size());
  for (std::size_t i = 0; i < first.solutions.size(); ++i) {
    EXPECT_EQ(first.solutions[i].T_reference_query, again.solutions[i].T_reference_query);
    EXPECT_EQ(first.solutions[i].fitness, again.solutions[i].fitness);
  }
  task_.seed = 99;
  task_.genetic.generations = 2;
  const SearchOutcome other = search();
  EXPECT_NE(first.solutions.back().T_reference_query, other.solutions.back().T_reference_query);
}

TEST_F(GeneticSearchTest, SolutionsAreDistinctSortedAndInsideTheSpace) {
  for (const std::uint32_t wanted : {1U, 3U, 40U}) {
    task_.solutions_wanted = wanted;
    const auto solutions = search().solutions;
    EXPECT_EQ(solutions.size(), wanted);
    for (std::size_t i = 0; i < solutions.size(); ++i) {
      const Pose2& T = solutions[i].T_reference_query;
      EXPECT_LE(std::fabs(T.x_m), 1.0 + 1e-9);
      EXPECT_LE(std::fabs(T.y_m), 1.0 + 1e-9);
      EXPECT_LE(std::fabs(T.theta_rad), 0.6 + 1e-9);
      if (i > 0) {
        EXPECT_LE(solutions[i].fitness, solutions[i - 1].fitness);
      }
      for (std::size_t k = 0; k < i; ++k) {
        const Pose2& other = solutions[k].T_reference_query;
        EXPECT_TRUE(test::distance_m(T, other) >= 1.5 * task_.genetic.resolution_m ||
                    test::turn_rad(T, other) >= 1.5 * task_.genetic.resolution_rad)
            << wanted << ": " << k << ", " << i;
      }
    }
  }
}

TEST_F(GeneticSearchTest, ReportedFitnessIsTheFitnessOfThePose) {
  const Fitness fitness(reference_, query_, task_);
  task_.solutions_wanted = 40;
  for (const MatchSolution& solution : search().solutions) {
    EXPECT_EQ(solution.fitness, fitness(solution.T_reference_query));
  }
}

TEST_F(GeneticSearchTest, EvaluatesAllButTheEliteOfEachGeneration) {
  EXPECT_EQ(search().evaluations, 100U + 49U * 98U);
  task_.genetic.individuals = 51;
  task_.genetic.generations = 3;
  EXPECT_EQ(search().evaluations, 51U + 2U * 49U);
}

TEST_F(GeneticSearchTest, StopsAtOnceWhereNothingIsInCommon) {
  task_.T_reference_query = {100.0, 0.0, 0.0};
  const SearchOutcome outcome = search();
  EXPECT_EQ(outcome.evaluations, 100U);
  for (const MatchSolution& solution : outcome.solutions) EXPECT_EQ(solution.fitness, 0.0);
}

TEST_F(GeneticSearchTest, StartsFromThePosesItIsGiven) {
  task_.genetic.individuals = 4;
  task_.genetic.generations = 1;
  task_.initial_individuals = {kTruth};
  const MatchSolution best = search().solutions.front();
  // The genes have at least the precision asked for.
  EXPECT_LT(test::distance_m(best.T_reference_query, kTruth), task_.genetic.resolution_m);
  EXPECT_LT(test::turn_rad(best.T_reference_query, kTruth), task_.genetic.resolution_rad);
}

TEST_F(GeneticSearchTest, HeadingMayCrossTheSeamOfTheAngle) {
  // The same room with the reference turned by half a turn: the answer lies beyond +pi.
  const MatchFeatures turned = test::features_at(test::l_room(), {0.3, 0.2, 179.0 * kDegree});
  task_.T_reference_query = {0.2, 0.1, 3.0};
  const SearchOutcome outcome = genetic_search(task_, Fitness(reference_, turned, task_));
  const Pose2& best = outcome.solutions.front().T_reference_query;
  EXPECT_LT(test::distance_m(best, {0.3, 0.2, 0.0}), task_.genetic.resolution_m);
  EXPECT_LT(test::turn_rad(best, {0, 0, 179.0 * kDegree}), 1.5 * task_.genetic.resolution_rad);
  for (const MatchSolution& solution : outcome.solutions) {
    EXPECT_LE(std::fabs(solution.T_reference_query.theta_rad), std::numbers::pi);
  }
}

}  // namespace
}  // namespace topogeo::localization
