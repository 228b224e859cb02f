#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/slam/loop/loop_decision.hpp"

namespace topogeo::localization {
namespace {

using Kind = LoopEvidence::Kind;

LoopEvidence passed() {
  LoopEvidence evidence;
  evidence.kind = Kind::kPassed;
  evidence.inliers = 0.95;
  evidence.weakest_sigma_m = 0.02;
  return evidence;
}

LoopEvidence doubtful() {
  LoopEvidence evidence = passed();
  evidence.kind = Kind::kDoubtful;
  evidence.inliers = 0.8;
  evidence.rivalry = 0.5;
  evidence.surprise = 3.0;
  evidence.weakest_sigma_m = 0.1;
  return evidence;
}

LoopEvidence window() {
  LoopEvidence evidence;
  evidence.kind = Kind::kWindow;
  evidence.fitness = 0.95;
  evidence.surprise = 3.0;
  evidence.weakest_sigma_m = 0.1;
  return evidence;
}

TEST(LoopProbability, IsTheLogisticFunctionOfItsTerms) {
  // Computed by hand: 2 (doubtful) + 1 * 0.8 - 3 * 0.5 - 1 * ln 4 = -0.0863.
  const LoopTerms coefficients{9.0, 2.0, 9.0, 9.0, 1.0, -3.0, 9.0, -1.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_NEAR(loop_probability(doubtful(), coefficients),
              1.0 / (1.0 + std::exp(-(2.0 + 0.8 - 1.5 - std::log(4.0)))), 1e-12);
  // 9 (window) + 2 * 0.95 - 10 * 0.1 - 1 * 0.1 * ln 4.
  const LoopTerms of_window{0.0, 0.0, 0.0, 9.0, 5.0, 5.0, 2.0, 0.0, -10.0, -1.0, 7.0, 7.0};
  EXPECT_NEAR(loop_probability(window(), of_window),
              1.0 / (1.0 + std::exp(-(9.0 + 1.9 - 1.0 - 0.1 * std::log(4.0)))), 1e-12);
}

TEST(LoopProbability, NothingInCommonIsNoMatch) {
  EXPECT_EQ(loop_probability(LoopEvidence{}), 0.0);
}

TEST(LoopProbability, WhatPassesItsGateIsNearlyCertainWhereverItWasPredicted) {
  EXPECT_GT(loop_probability(passed()), 0.999);
  LoopEvidence far = passed();
  far.surprise = 100.0;
  EXPECT_EQ(loop_probability(far), loop_probability(passed()));
}

TEST(LoopProbability, EvidenceAgainstAMatchLowersIt) {
  for (const LoopEvidence& match : {doubtful(), window()}) {
    const double before = loop_probability(match);
    EXPECT_GT(before, 0.8);
    LoopEvidence surprising = match;
    surprising.surprise = 200.0;
    EXPECT_LT(loop_probability(surprising), 0.4);
    LoopEvidence along_corridor = surprising;  // any place along it fits
    along_corridor.weakest_sigma_m = 1.0;
    EXPECT_LT(loop_probability(along_corridor), 0.01);
    LoopEvidence contradicted = match;
    contradicted.contradicted = true;
    EXPECT_LT(loop_probability(contradicted), before);
  }
  LoopEvidence other = doubtful();
  other.rivalry = 1.0;
  EXPECT_LT(loop_probability(other), loop_probability(doubtful()));
  other = doubtful();
  other.inliers = 0.4;
  EXPECT_LT(loop_probability(other), loop_probability(doubtful()));
}

TEST(LoopProbability, AgreementDoublesTheOddsAtLeast) {
  const auto odds = [](double probability) { return probability / (1.0 - probability); };
  for (LoopEvidence match : {doubtful(), window()}) {
    match.surprise = 20.0;
    const double alone = loop_probability(match);
    match.agreement = 4.0;
    const double together = loop_probability(match);
    EXPECT_GT(odds(together), 2.0 * odds(alone));
  }
}

}  // namespace
}  // namespace topogeo::localization
