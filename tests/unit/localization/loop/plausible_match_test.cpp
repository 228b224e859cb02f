#include "topogeo/slam/loop/plausible_match.hpp"

#include <gtest/gtest.h>

#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::localization {
namespace {

using Limits = PlausibleMatch;

/// A doubtful match at the limit in every respect.
MatchQuality barely_plausible() {
  return {.doubted = true,
          .doubt = Limits::kMostDoubt,
          .inliers = Limits::kLeastInliers,
          .overlap = Limits::kLeastOverlap,
          .violations = Limits::kMostViolations,
          .rivalry = Limits::kMostRivalry,
          .weakest_sigma_m = Limits::kLeastKnown_m};
}

TEST(PlausibleMatch, EachLimitCounts) {
  EXPECT_TRUE(plausible(barely_plausible()));
  const auto refused = [](double MatchQuality::*value, double change) {
    MatchQuality match = barely_plausible();
    match.*value += change;
    return !plausible(match);
  };
  EXPECT_TRUE(refused(&MatchQuality::doubt, 0.01));
  EXPECT_TRUE(refused(&MatchQuality::inliers, -0.01));
  EXPECT_TRUE(refused(&MatchQuality::overlap, -0.01));
  EXPECT_TRUE(refused(&MatchQuality::violations, 0.01));
  EXPECT_TRUE(refused(&MatchQuality::rivalry, 0.01));
  EXPECT_TRUE(refused(&MatchQuality::weakest_sigma_m, 0.01));
}

TEST(PlausibleMatch, AnAcceptedMatchNeedsOnlyADeterminedPosition) {
  MatchQuality match{.accepted = true, .doubt = 9.0};
  EXPECT_TRUE(plausible(match));
  match.weakest_sigma_m = 0.3;
  EXPECT_FALSE(plausible(match));
}

TEST(PlausibleMatch, ARefutedMatchIsNot) {
  MatchQuality match = barely_plausible();
  match.doubted = false;
  EXPECT_FALSE(plausible(match));
  EXPECT_TRUE(is_doubted(Reason::kSecondSolution));
  EXPECT_FALSE(is_doubted(Reason::kFewInliers));
}

}  // namespace
}  // namespace topogeo::localization
