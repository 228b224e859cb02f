#include "genetic_search_parts.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

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

// The coarse resolution takes headings from a table, the fine one does not.
TEST(GeneCodingTest, GenesAndPosesAreEachOthersInverse) {
  for (const double resolution_m : {0.15, 0.001}) {
    MatchTask task;
    task.T_reference_query = {3.0, -2.0, 3.0};  // the heading crosses the seam
    task.half_width = {1.5, 0.7, 0.4};
    task.genetic.resolution_m = resolution_m;
    GeneCoding coding;
    coding.bind(task);
    support::Random random(4);
    for (int i = 0; i < 2000; ++i) {
      Chromosome genes;
      for (std::uint32_t& gene : genes) {
        gene = static_cast<std::uint32_t>(random.below(coding.largest() + 1ULL));
      }
      const GeneCoding::Place place = coding.decode(genes);
      ASSERT_EQ(coding.encode(place.T_reference_query), genes);
      ASSERT_NEAR(place.heading.cos, std::cos(place.T_reference_query.theta_rad), 1e-12);
      ASSERT_NEAR(place.heading.sin, std::sin(place.T_reference_query.theta_rad), 1e-12);
    }
  }
}

TEST(GeneCodingTest, TheEndsOfTheGenesAreTheEndsOfTheSpace) {
  MatchTask task;
  task.T_reference_query = {3.0, -2.0, 0.1};
  task.half_width = {1.5, 0.7, 0.4};
  GeneCoding coding;
  coding.bind(task);
  const Pose2 low = coding.decode({0, 0, 0}).T_reference_query;
  EXPECT_NEAR(low.x_m, 1.5, 1e-12);
  EXPECT_NEAR(low.y_m, -2.7, 1e-12);
  EXPECT_NEAR(low.theta_rad, -0.3, 1e-12);
  const std::uint32_t last = coding.largest();
  const Pose2 high = coding.decode({last, last, last}).T_reference_query;
  EXPECT_NEAR(high.x_m, 4.5, 1e-12);
  EXPECT_NEAR(high.y_m, -1.3, 1e-12);
  EXPECT_NEAR(high.theta_rad, 0.5, 1e-12);
  EXPECT_EQ(coding.encode({99.0, -99.0, 0.1}),
            (Chromosome{last, 0, coding.encode({3, -2, 0.1})[2]}));
}

TEST(FitnessTableTest, AsksOnceAndForgetsAtTheNextStart) {
  FitnessTable table;
  int asked = 0;
  const auto ask = [&asked](double value) {
    return [&asked, value] {
      ++asked;
      return value;
    };
  };
  table.start(5, 1000);
  EXPECT_EQ(table({1, 2, 3}, ask(0.5)), 0.5);
  EXPECT_EQ(table({1, 2, 3}, ask(0.6)), 0.5);
  EXPECT_EQ(table({3, 2, 1}, ask(0.7)), 0.7);
  EXPECT_EQ(table({0, 0, 0}, ask(0.8)), 0.8);
  EXPECT_EQ(table({0, 0, 0}, ask(0.9)), 0.8);
  EXPECT_EQ(asked, 3);
  table.start(5, 1000);
  EXPECT_EQ(table({1, 2, 3}, ask(0.1)), 0.1);
  EXPECT_EQ(asked, 4);
}

// More chromosomes than slots, genes of every length, several starts: an answer may be lost and
// requested again, but it is never that of another chromosome.
TEST(FitnessTableTest, NeverMixesUpChromosomes) {
  FitnessTable table;
  support::Random random(9);
  for (const std::uint32_t bits : {1U, 4U, 6U, 13U, 14U, 24U, 5U}) {
    for (const double offset : {0.0, 0.5}) {
      table.start(bits, 200);
      for (int i = 0; i < 3000; ++i) {
        Chromosome genes;
        for (std::uint32_t& gene : genes) {
          gene = static_cast<std::uint32_t>(random.below(std::uint64_t{1} << std::min(bits, 4U)));
        }
        genes[2] <<= bits - std::min(bits, 4U);
        const double right = offset + genes[0] + 1e3 * genes[1] + 1e6 * genes[2];
        ASSERT_EQ(table(genes, [&] { return right; }), right) << bits;
      }
    }
  }
}

TEST(RouletteTest, DrawsInProportionToFitness) {
  const std::vector<double> fitness{0.1, 0.0, 0.4, 0.0, 0.2, 0.3, 0.0};
  std::vector<Individual> population;
  population.reserve(fitness.size());
  for (const double value : fitness) population.push_back({{}, value});
  Roulette roulette;
  roulette.fill(population);
  ASSERT_FALSE(roulette.empty());
  std::vector<int> drawn(fitness.size(), 0);
  support::Random random(2);
  constexpr int kSpins = 100000;
  for (int i = 0; i < kSpins; ++i) ++drawn[roulette.spin(random)];
  for (std::size_t i = 0; i < fitness.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(drawn[i]) / kSpins, fitness[i], 0.006) << i;
    if (fitness[i] == 0.0) {
      EXPECT_EQ(drawn[i], 0) << i;
    }
  }
}

TEST(RouletteTest, IsEmptyWhenNobodyIsFit) {
  Roulette roulette;
  roulette.fill(std::vector<Individual>(5));
  EXPECT_TRUE(roulette.empty());
  std::vector<Individual> one(5);
  one[4].fitness = 1e-12;
  roulette.fill(one);
  EXPECT_FALSE(roulette.empty());
  support::Random random(1);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(roulette.spin(random), 4U);
}

TEST(CrossTest, ExchangesTheLowBitsOfEveryGeneAtOnePlace) {
  support::Random random(3);
  std::array<int, 8> cuts{};
  for (int i = 0; i < 7000; ++i) {
    Chromosome a{0xff, 0x0f, 0x00};
    Chromosome b{0x00, 0xf0, 0xff};
    cross(a, b, 8, random);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(a[k] ^ b[k], 0xffU);
    const int cut = std::countr_zero(a[0]);  // the trailing zeros came from b
    ASSERT_GE(cut, 1);
    ASSERT_LE(cut, 7);
    EXPECT_EQ(a[2], 0xffU >> (8 - cut));
    ++cuts[static_cast<std::size_t>(cut)];
  }
  for (std::size_t cut = 1; cut < 8; ++cut) EXPECT_NEAR(cuts[cut], 1000, 150) << cut;
}

TEST(CrossTest, OneBitCannotBeCut) {
  support::Random random(3);
  Chromosome a{1, 0, 1};
  Chromosome b{0, 0, 0};
  cross(a, b, 1, random);
  EXPECT_EQ(a, (Chromosome{1, 0, 1}));
}

TEST(MutationTest, FlipsEveryBitWithTheSameProbability) {
  for (const double rate : {0.01, 0.05, 0.2, 0.5}) {
    constexpr std::uint32_t kBits = 6;
    Mutation mutation;
    mutation.bind(kBits, rate);
    support::Random random(7);
    constexpr int kRuns = 40000;
    std::array<int, 18> flips{};
    int pairs = 0;  // the first two bits together
    for (int i = 0; i < kRuns; ++i) {
      Chromosome genes{};
      mutation(genes, random);
      for (std::size_t bit = 0; bit < flips.size(); ++bit) {
        ASSERT_EQ(genes[bit / kBits] >> kBits, 0U);
        flips[bit] += static_cast<int>(genes[bit / kBits] >> (bit % kBits) & 1U);
      }
      pairs += (genes[0] & 3U) == 3U ? 1 : 0;
    }
    for (const int count : flips) EXPECT_NEAR(count / double{kRuns}, rate, 0.012) << rate;
    EXPECT_NEAR(pairs / double{kRuns}, rate * rate, 0.01) << "independent";
  }
}

TEST(MutationTest, NeverAtARateOfZero) {
  Mutation mutation;
  mutation.bind(24, 0.0);
  support::Random random(7);
  for (int i = 0; i < 1000; ++i) {
    Chromosome genes{1, 2, 3};
    mutation(genes, random);
    ASSERT_EQ(genes, (Chromosome{1, 2, 3}));
  }
}

}  // namespace
}  // namespace topogeo::localization
