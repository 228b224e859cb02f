#include "genetic_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "fitness_combined.hpp"
#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

struct SearchOutcome {
  std::vector<MatchSolution> solutions;
  std::uint32_t evaluations = 0;
};

// The L-shaped room from two places; the search starts with a prediction well off the truth.
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

  SearchOutcome search(std::span<const Pose2> hypotheses = {}) const {
    return search(CombinedFitness(reference_, query_, task_), hypotheses);
  }
  SearchOutcome search(const Fitness& fitness, std::span<const Pose2> hypotheses = {}) const {
    GeneticSearch search;
    SearchOutcome outcome;
    outcome.evaluations = search.run(task_, fitness, hypotheses);
    search.best_distinct(
        task_.solutions_wanted,
        [&](const Pose2& a, const Pose2& b) { return same_solution(task_, a, b); },
        outcome.solutions);
    return outcome;
  }
  // All poses that a search evaluated.
  std::vector<MatchSolution> met() const {
    GeneticSearch search;
    search.run(task_, CombinedFitness(reference_, query_, task_), {});
    std::vector<MatchSolution> all;
    search.best_distinct(1'000'000, std::equal_to<Pose2>{}, all);
    return all;
  }

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
  const CombinedFitness fitness(reference_, query_, task_);
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
  // The genes have at least the required precision.
  EXPECT_LT(test::distance_m(best.T_reference_query, kTruth), task_.genetic.resolution_m);
  EXPECT_LT(test::turn_rad(best.T_reference_query, kTruth), task_.genetic.resolution_rad);
}

TEST_F(GeneticSearchTest, StartsFromHypothesesAfterThem) {
  task_.genetic.individuals = 4;
  task_.genetic.generations = 1;
  const std::vector<Pose2> hypotheses{kTruth};
  EXPECT_LT(test::distance_m(search(hypotheses).solutions.front().T_reference_query, kTruth), 0.15);
  // The population has room for the prediction and three more.
  task_.initial_individuals = {{0.9, 0.9, 0.5}, {0.9, -0.9, 0.5}, {-0.9, 0.9, 0.5}};
  EXPECT_GT(test::distance_m(search(hypotheses).solutions.front().T_reference_query, kTruth), 0.15);
}

// Without crossover and mutation no new individual appears.
TEST_F(GeneticSearchTest, HonoursTheRatesOfCrossoverAndMutation) {
  task_.genetic.mutation_rate = 0.0;
  task_.genetic.crossover_rate = 0.0;
  EXPECT_LE(met().size(), 100U);
  task_.genetic.crossover_rate = 0.1;
  const std::size_t few = met().size();
  EXPECT_GT(few, 110U);
  task_.genetic.crossover_rate = 1.0;
  EXPECT_GT(met().size(), few);
  task_.genetic.crossover_rate = 0.0;
  task_.genetic.mutation_rate = 0.05;
  EXPECT_GT(met().size(), 500U);
}

// If all but one individual are elite, each generation has at most one child.
TEST_F(GeneticSearchTest, HonoursTheElite) {
  task_.genetic.elite = 99;
  EXPECT_EQ(search().evaluations, 100U + 49U);
  task_.genetic.elite = 1;
  EXPECT_EQ(search().evaluations, 100U + 49U * 99U);
}

TEST_F(GeneticSearchTest, TheElitesFitnessNeverFalls) {
  task_.genetic.mutation_rate = 0.5;  // only the elite would keep a good solution
  double before = 0.0;
  for (task_.genetic.generations = 1; task_.genetic.generations < 60;
       task_.genetic.generations += 7) {
    const double best = search().solutions.front().fitness;
    EXPECT_GE(best, before);
    before = best;
  }
}

// Earlier searches of an object make no difference.
TEST_F(GeneticSearchTest, AnObjectRemembersNothing) {
  GeneticSearch used;
  MatchTask other = task_;
  other.half_width = {3.0, 3.0, 1.0};
  other.genetic.individuals = 300;
  other.genetic.elite = 5;
  const CombinedFitness fitness(reference_, query_, task_);
  used.run(other, fitness, {});
  used.run(task_, fitness, {});
  std::vector<MatchSolution> again;
  used.best_distinct(1'000'000, std::equal_to<Pose2>{}, again);
  const std::vector<MatchSolution> fresh = met();
  ASSERT_EQ(again.size(), fresh.size());
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    ASSERT_EQ(again[i].T_reference_query, fresh[i].T_reference_query);
    ASSERT_EQ(again[i].fitness, fresh[i].fitness);
  }
}

TEST_F(GeneticSearchTest, TheBestDistinctAreTheBestOfAllThatWereMet) {
  const std::vector<MatchSolution> all = met();
  task_.solutions_wanted = 10;
  const std::vector<MatchSolution> chosen = search().solutions;
  std::vector<MatchSolution> expected;
  for (const MatchSolution& candidate : all) {  // best first
    const bool known = std::any_of(expected.begin(), expected.end(), [&](const MatchSolution& s) {
      return same_solution(task_, s.T_reference_query, candidate.T_reference_query);
    });
    if (!known && expected.size() < 10) expected.push_back(candidate);
  }
  ASSERT_EQ(chosen.size(), expected.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    EXPECT_EQ(chosen[i].T_reference_query, expected[i].T_reference_query) << i;
  }
}

TEST_F(GeneticSearchTest, HeadingMayCrossTheSeamOfTheAngle) {
  // The same room with the reference turned by half a turn: the answer is beyond +pi.
  const MatchFeatures turned = test::features_at(test::l_room(), {0.3, 0.2, 179.0 * kDegree});
  task_.T_reference_query = {0.2, 0.1, 3.0};
  const SearchOutcome outcome = search(CombinedFitness(reference_, turned, task_));
  const Pose2& best = outcome.solutions.front().T_reference_query;
  EXPECT_LT(test::distance_m(best, {0.3, 0.2, 0.0}), task_.genetic.resolution_m);
  EXPECT_LT(test::turn_rad(best, {0, 0, 179.0 * kDegree}), 1.5 * task_.genetic.resolution_rad);
  for (const MatchSolution& solution : outcome.solutions) {
    EXPECT_LE(std::fabs(solution.T_reference_query.theta_rad), std::numbers::pi);
  }
}

}  // namespace
}  // namespace topogeo::localization
