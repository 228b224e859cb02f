#include "drive_agreement.hpp"

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

/// So many successive stops, each matched at its expected pose.
DriveAgreement agreed(int stops, double step_m, bool accepted, double confidence = 1.0) {
  DriveAgreement agreement;
  for (int i = 0; i < stops; ++i) {
    agreement.move(step_m);
    agreement.add(accepted, confidence);
  }
  return agreement;
}

TEST(DriveAgreement, NothingProvesNothing) {
  EXPECT_FALSE(DriveAgreement{}.enough());
  EXPECT_EQ(DriveAgreement{}.weight(), 0.0);
}

TEST(DriveAgreement, ThreeAcceptedOrFourDoubtfulStopsAreEnough) {
  EXPECT_FALSE(agreed(2, 1.0, true).enough());
  EXPECT_TRUE(agreed(3, 1.0, true).enough());
  EXPECT_FALSE(agreed(3, 1.0, false).enough());
  EXPECT_TRUE(agreed(4, 1.0, false).enough());
}

TEST(DriveAgreement, MatchesThatAreHardlyRightCountLess) {
  EXPECT_FALSE(agreed(6, 1.0, false, 0.5).enough());
  EXPECT_TRUE(agreed(8, 1.0, false, 0.5).enough());
}

TEST(DriveAgreement, ARobotThatStandsSeesTheSameAgainAndAgain) {
  EXPECT_FALSE(agreed(50, 0.0, true).enough());
  EXPECT_FALSE(agreed(10, 0.1, true).enough());
}

TEST(DriveAgreement, WhatContradictsTakesAwayWhatAgreed) {
  DriveAgreement agreement = agreed(4, 1.0, false);
  agreement.contradict();
  EXPECT_FALSE(agreement.enough());
  EXPECT_EQ(agreement.weight(), 3.0);
}

TEST(DriveAgreement, WhatIsFarBehindIsForgotten) {
  DriveAgreement agreement = agreed(4, 1.0, true);
  agreement.move(20.0);
  EXPECT_EQ(agreement.weight(), 0.0);
  EXPECT_FALSE(agreement.enough());
}

}  // namespace
}  // namespace topogeo::localization
