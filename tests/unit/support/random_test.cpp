#include "topogeo/support/random.hpp"

#include <array>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/support/hash.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::support {
namespace {

TEST(Hash, GivesThePublishedFnv1aValues) {
  EXPECT_EQ(fnv1a(""), 0xcbf29ce484222325ULL);
  EXPECT_EQ(fnv1a("a"), 0xaf63dc4c8601ec8cULL);
  EXPECT_EQ(fnv1a("foobar"), 0x85944171f73967e8ULL);
}

TEST(Seed, GivesThePublishedSplitmixValues) {
  // First outputs of splitmix64 with the state 0.
  EXPECT_EQ(splitmix64(0), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(splitmix64(0x9e3779b97f4a7c15ULL), 0x6e789e6aa1b965f4ULL);
}

TEST(Seed, DependsOnEveryPartAndItsPlace) {
  const std::set<std::uint64_t> seeds{
      derive_seed(1, "robot", {1, 2}), derive_seed(2, "robot", {1, 2}),
      derive_seed(1, "tobor", {1, 2}), derive_seed(1, "robot", {2, 1}),
      derive_seed(1, "robot", {1}),    derive_seed(1, "robot", {1, 2, 0}),
      derive_seed(1, "robot", {})};
  EXPECT_EQ(seeds.size(), 7U);
  EXPECT_EQ(derive_seed(1, "robot", {1, 2}), derive_seed(1, "robot", {1, 2}));
}

TEST(Random, IsTheSameOnEveryMachine) {
  // xoshiro256** from the state that splitmix64 derives from 0, by its authors' code.
  Random random(0);
  EXPECT_EQ(random.next_u64(), 0x99ec5f36cb75f2b4ULL);
  EXPECT_EQ(random.next_u64(), 0xbf6e1f784956452aULL);
}

TEST(Random, UniformFillsTheUnitInterval) {
  Random random(7);
  double sum = 0.0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 0.005);
  EXPECT_EQ(random.uniform(2.5, 2.5), 2.5);
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(-2.0, 3.0);
    ASSERT_GE(u, -2.0);
    ASSERT_LT(u, 3.0);
  }
}

TEST(Random, BelowGivesEveryValueEquallyOften) {
  Random random(11);
  std::array<int, 7> counts{};
  for (int i = 0; i < 70000; ++i) ++counts.at(random.below(7));
  for (const int count : counts) EXPECT_NEAR(count, 10000, 400);
  EXPECT_EQ(random.below(1), 0U);
  // With 3 * 2^62 values a plain remainder would return the lowest third twice as often.
  const std::uint64_t n = 3ULL << 62U;
  int low = 0;
  for (int i = 0; i < 30000; ++i) low += random.below(n) < n / 3 ? 1 : 0;
  EXPECT_NEAR(low, 10000, 400);
  EXPECT_THROW(random.below(0), std::invalid_argument);
}

TEST(Random, NormalHasTheRightMoments) {
  Random random(3);
  double sum = 0.0;
  double squares = 0.0;
  double fourths = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.02);
  EXPECT_NEAR(fourths / kDraws, 3.0, 0.1);
}

}  // namespace
}  // namespace topogeo::support
