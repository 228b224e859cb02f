#include "topogeo/pipeline/reliability.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

TEST(ReliabilityTest, IsEmptyAtFirst) {
  const Reliability reliability;
  EXPECT_EQ(reliability.count(), 0U);
  EXPECT_EQ(reliability.brier(), 0.0);
  EXPECT_EQ(reliability.log_loss(), 0.0);
  EXPECT_EQ(reliability.tenths()[9].mean_stated(), 0.0);
  EXPECT_EQ(reliability.tenths()[9].share_right(), 0.0);
}

TEST(ReliabilityTest, CountsByTenths) {
  Reliability reliability;
  reliability.add(0.0, false);
  reliability.add(0.15, false);
  reliability.add(0.19, true);
  reliability.add(0.2, false);  // the next tenth
  reliability.add(1.0, true);   // the last one
  EXPECT_EQ(reliability.count(), 5U);
  EXPECT_EQ(reliability.right(), 2U);
  EXPECT_EQ(reliability.tenths()[0].count, 1U);
  EXPECT_EQ(reliability.tenths()[1].count, 2U);
  EXPECT_NEAR(reliability.tenths()[1].mean_stated(), 0.17, 1e-12);
  EXPECT_NEAR(reliability.tenths()[1].share_right(), 0.5, 1e-12);
  EXPECT_EQ(reliability.tenths()[2].count, 1U);
  EXPECT_EQ(reliability.tenths()[9].right, 1U);
}

// Computed by hand: (0.2^2 + 0.6^2) / 2 and -(ln 0.8 + ln 0.4) / 2.
TEST(ReliabilityTest, ScoresAreThoseOfTheTruth) {
  Reliability reliability;
  reliability.add(0.8, true);
  reliability.add(0.6, false);
  EXPECT_NEAR(reliability.brier(), 0.2, 1e-12);
  EXPECT_NEAR(reliability.log_loss(), -0.5 * (std::log(0.8) + std::log(0.4)), 1e-12);
}

TEST(ReliabilityTest, WhatWasCertainAndWrongIsBoundedInItsLoss) {
  Reliability reliability;
  reliability.add(1.0, false);
  EXPECT_EQ(reliability.brier(), 1.0);
  EXPECT_NEAR(reliability.log_loss(), -std::log(1e-9), 1e-9);
}

}  // namespace
}  // namespace topogeo::pipeline
