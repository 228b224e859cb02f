// Verdicts depend on values alone.
#include "reproduce/measured.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace topogeo::reproduce {
namespace {

Value value_of(double measured, double expected, Relation relation, double tolerance = 0.0) {
  return {.name = "length",
          .unit = "m",
          .measured = measured,
          .expected = expected,
          .relation = relation,
          .tolerance = tolerance};
}

TEST(Verdict, EqualWithinTheToleranceAndElseDifferent) {
  EXPECT_EQ(verdict_of(value_of(1.0, 1.1, Relation::kEqual, 0.11)), Verdict::kEqual);
  EXPECT_EQ(verdict_of(value_of(1.0, 1.1, Relation::kEqual, 0.09)), Verdict::kDiffers);
}

TEST(Verdict, LessOrMoreIsBetterInOneDirectionOnly) {
  EXPECT_EQ(verdict_of(value_of(1.0, 2.0, Relation::kSmaller)), Verdict::kBetter);
  EXPECT_EQ(verdict_of(value_of(3.0, 2.0, Relation::kSmaller)), Verdict::kDiffers);
  EXPECT_EQ(verdict_of(value_of(3.0, 2.0, Relation::kLarger)), Verdict::kBetter);
  EXPECT_EQ(verdict_of(value_of(1.0, 2.0, Relation::kLarger)), Verdict::kDiffers);
  EXPECT_EQ(verdict_of(value_of(2.05, 2.0, Relation::kSmaller, 0.1)), Verdict::kEqual);
}

TEST(Verdict, ANumberThatIsNotFiniteDiffers) {
  EXPECT_EQ(verdict_of(value_of(NAN, 2.0, Relation::kSmaller)), Verdict::kDiffers);
  EXPECT_EQ(verdict_of(value_of(-INFINITY, 2.0, Relation::kSmaller)), Verdict::kDiffers);
}

TEST(Verdict, OneDifferenceOutweighsWhatIsBetter) {
  const Value equal = value_of(1.0, 1.0, Relation::kEqual);
  const Value better = value_of(1.0, 2.0, Relation::kSmaller);
  const Value differs = value_of(1.0, 2.0, Relation::kEqual);
  EXPECT_EQ(verdict_of(std::vector{equal, equal}), Verdict::kEqual);
  EXPECT_EQ(verdict_of(std::vector{equal, better}), Verdict::kBetter);
  EXPECT_EQ(verdict_of(std::vector{better, differs, equal}), Verdict::kDiffers);
  EXPECT_EQ(differences({better, differs}), "length: 1 m instead of 2 m");
}

TEST(Verdict, NothingComparedIsNoAgreement) {
  EXPECT_EQ(verdict_of(std::vector<Value>{}), Verdict::kDiffers);
  EXPECT_EQ(verdict_of(std::vector{Value{.name = "shown", .measured = 1.0}}), Verdict::kDiffers);
}

// A value of other means has no expected one, whatever it measures.
TEST(Verdict, ValuesBesideAreNotCompared) {
  Value beside = value_of(1.0, 2.0, Relation::kEqual);
  beside.expected.reset();
  beside.by = "other means";
  EXPECT_EQ(verdict_of(std::vector{value_of(1.0, 1.0, Relation::kEqual), beside}), Verdict::kEqual);
  EXPECT_EQ(verdict_of(std::vector{beside}), Verdict::kDiffers);
}

TEST(Verdict, TimesAreThoseOfOurOwnWork) {
  EXPECT_TRUE(is_time(Value{.name = "match", .unit = "s"}));
  EXPECT_TRUE(is_time(Value{.name = "local map", .unit = "ms"}));
  EXPECT_FALSE(is_time(Value{.name = "length", .unit = "m"}));
}

TEST(TextOf, MeansNameMatcherRangeAndRuns) {
  EXPECT_EQ(text_of(Means{}), "no matching, no laser, 1 run");
  EXPECT_EQ(text_of(Means{"printed form", 4.0, 20}), "printed form, 4 m, 20 runs");
}

TEST(TextOf, StatementsAreWordsAndNumbersHaveTheirUnits) {
  EXPECT_EQ(text_of(1.0, "yes"), "yes");
  EXPECT_EQ(text_of(0.0, "yes"), "no");
  EXPECT_EQ(text_of(0.123456, "m"), "0.1235 m");
  EXPECT_EQ(text_of(62.0, ""), "62");
}

}  // namespace
}  // namespace topogeo::reproduce
