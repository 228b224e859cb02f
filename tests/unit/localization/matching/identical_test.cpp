#include <gtest/gtest.h>

#include "topogeo/matching/match.hpp"

namespace topogeo::localization {
namespace {

TEST(Identical, OneBitMakesADifference) {
  MatchResult one;
  one.task_id = 7;
  one.status = MatchStatus::kSolved;
  one.solutions.resize(2);
  one.T_reference_query = {1.0, -2.0, 0.5};
  one.covariance.diagonal().setConstant(1e-3);
  const auto differs = [&](const auto& change) {
    MatchResult other = one;
    change(other);
    return !identical(one, other);
  };
  EXPECT_FALSE(differs([](auto&) {}));
  EXPECT_TRUE(differs([](auto& r) { r.covariance(2, 1) = -0.0; })) << "not even the sign of zero";
  EXPECT_TRUE(differs([](auto& r) { r.second.T_reference_query.y_m = 1e-300; }));
  EXPECT_TRUE(differs([](auto& r) { r.solutions[1].fitness = 1e-300; }));
  EXPECT_TRUE(differs([](auto& r) { r.solutions.pop_back(); }));
  EXPECT_TRUE(differs([](auto& r) { r.seed = 1; }));
  EXPECT_TRUE(differs([](auto& r) { r.verdict = Verdict::kAccepted; }));
  EXPECT_TRUE(differs([](auto& r) { r.reason = Reason::kDoubtful; }));
}

}  // namespace
}  // namespace topogeo::localization
