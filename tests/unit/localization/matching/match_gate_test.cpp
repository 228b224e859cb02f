#include "topogeo/matching/match_gate.hpp"

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

class MatchGateTest : public testing::Test {
 protected:
  MatchGateTest() {
    task_.T_reference_query = {1.0, 0.0, 0.1};
    task_.covariance.diagonal() << 0.01, 0.01, 0.0025;
    task_.half_width = {0.25, 0.25, 0.1};
    result_.status = MatchStatus::kSolved;
    result_.T_reference_query = {1.05, -0.05, 0.12};
    result_.covariance.diagonal() << 1e-4, 1e-4, 2.5e-5;
    result_.overlap = 0.9;
    result_.inliers = 0.95;
    result_.violations = 0.012;
    result_.residual_rms_m = 0.02;
    result_.scan_fitness = 0.7;
    result_.solutions = {{result_.T_reference_query, 0.8}};
    result_.fitness = 0.8;
  }
  Reason reason() const {
    const Judgement judgement = judge(task_, result_);
    EXPECT_EQ(judgement.verdict, judgement.reason == Reason::kNone ? Verdict::kAccepted
                                 : judgement.reason == Reason::kSecondSolution
                                     ? Verdict::kAmbiguous
                                     : Verdict::kRejected);
    return judgement.reason;
  }

  MatchTask task_;
  MatchResult result_;
};

TEST_F(MatchGateTest, AcceptsAGoodMatch) {
  EXPECT_EQ(reason(), Reason::kNone);
}

TEST_F(MatchGateTest, RejectsWhatFoundNothing) {
  result_.status = MatchStatus::kNothingInCommon;
  EXPECT_EQ(reason(), Reason::kNothingInCommon);
  result_.status = MatchStatus::kSolved;
  result_.covariance.setZero();
  EXPECT_EQ(reason(), Reason::kNothingInCommon);
}

TEST_F(MatchGateTest, RejectsLittleOverlapAndFewInliers) {
  result_.overlap = 0.19;
  EXPECT_EQ(reason(), Reason::kLittleOverlap);
  result_.overlap = 0.21;
  EXPECT_EQ(reason(), Reason::kNone);
  result_.inliers = 0.49;
  EXPECT_EQ(reason(), Reason::kFewInliers);
}

TEST_F(MatchGateTest, DoubtAddsUpItsParts) {
  MatchResult perfect = result_;
  perfect.inliers = 1.0;
  perfect.violations = 0.0;
  perfect.residual_rms_m = 0.0;
  EXPECT_EQ(doubt(perfect), 0.0);
  result_.violations = 0.06;      // half of 0.12
  result_.inliers = 0.82;         // 0.10 below 0.92, half of 0.20
  result_.residual_rms_m = 0.04;  // half of 0.08
  result_.scan_fitness = 0.40;    // 0.10 below 0.50, half of 0.20
  EXPECT_NEAR(doubt(result_), 2.0, 1e-12);
}

TEST_F(MatchGateTest, AllowsLessDoubtForAWiderSearch) {
  result_.violations = 0.06;
  result_.inliers = 0.82;
  result_.residual_rms_m = 0.04;
  result_.scan_fitness = 0.40;  // doubt 2.0; 2.2 - 0.25 per metre of half-width is permitted
  task_.half_width.x() = 0.7;
  EXPECT_EQ(reason(), Reason::kNone);
  task_.half_width.y() = 0.9;
  EXPECT_EQ(reason(), Reason::kDoubtful);
}

TEST_F(MatchGateTest, RejectsWhatThePredictionRulesOut) {
  result_.T_reference_query = {1.49, 0.0, 0.1};  // 4.9 deviations
  EXPECT_EQ(reason(), Reason::kNone);
  result_.T_reference_query = {1.51, 0.0, 0.1};  // 5.1 deviations; the limit is 25, squared
  EXPECT_EQ(reason(), Reason::kImplausible);
  result_.T_reference_query = {1.0, 0.0, 0.1 + 0.26};
  EXPECT_EQ(reason(), Reason::kImplausible);
}

TEST_F(MatchGateTest, ComparesHeadingsAcrossTheSeam) {
  task_.T_reference_query.theta_rad = 3.14;
  result_.T_reference_query.theta_rad = -3.14;
  EXPECT_EQ(reason(), Reason::kNone);
}

TEST_F(MatchGateTest, RejectsAMatchThatHasARival) {
  result_.violations = 0.0;
  result_.second = {result_.T_reference_query, 0.95 * 0.8 + 0.001};
  EXPECT_EQ(reason(), Reason::kSecondSolution);
  result_.second.fitness = 0.95 * 0.8 - 0.001;
  EXPECT_EQ(reason(), Reason::kNone);
}

TEST_F(MatchGateTest, ViolationsAndARivalAddUp) {
  result_.second = {result_.T_reference_query, 0.5 * 0.8};
  result_.violations = 0.059;  // a little less than half of 0.12
  EXPECT_EQ(reason(), Reason::kNone);
  result_.violations = 0.061;
  EXPECT_EQ(reason(), Reason::kDoubtful);
  result_.second.fitness = 0.48 * 0.8;
  EXPECT_EQ(reason(), Reason::kNone);
}

TEST_F(MatchGateTest, OdometryDoesNotSpeakAgainstARival) {
  // At 3.46 deviations from the prediction, the prior of the combined form is a half.
  const Pose2 far{1.0 + 0.1 * std::sqrt(12.0), 0.0, 0.1};
  result_.T_reference_query = task_.T_reference_query;
  result_.second = {far, 0.5 * 0.8};
  EXPECT_NEAR(rivalry(task_, result_), 1.0, 1e-12);
  EXPECT_EQ(reason(), Reason::kSecondSolution);
  std::swap(result_.T_reference_query, result_.second.T_reference_query);
  EXPECT_NEAR(rivalry(task_, result_), 0.25, 1e-12);
  task_.fitness_form = FitnessForm::kTopological;  // a form without odometry
  EXPECT_NEAR(rivalry(task_, result_), 0.5, 1e-12);
  result_.second.fitness = 0.0;
  EXPECT_EQ(rivalry(task_, result_), 0.0);
}

TEST_F(MatchGateTest, EveryReasonHasWordsOfItsOwn) {
  std::set<std::string> words;
  for (std::size_t i = 0; i < kReasons; ++i) words.insert(to_string(static_cast<Reason>(i)));
  EXPECT_EQ(words.size(), kReasons);
  EXPECT_EQ(words.count("unknown"), 0U);
}

TEST_F(MatchGateTest, CovarianceHasAFloorForThePerfectMatch) {
  const Eigen::Matrix3d covariance = match_covariance(Eigen::Matrix3d::Identity() * 1e12, 0.0);
  EXPECT_NEAR(covariance(0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(covariance(2, 2), 0.0052 * 0.0052, 1e-9);
}

TEST_F(MatchGateTest, CovarianceByHand) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information.diagonal() << 99.75, 0.0, 399.75;
  const Eigen::Matrix3d covariance = match_covariance(information, 0.5);  // unscaled deviation
  EXPECT_NEAR(covariance(0, 0), 0.01 + 0.0004, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 4.0 + 0.0004, 1e-9);  // unknown along y: 2 m, not infinite
  EXPECT_NEAR(covariance(2, 2), 0.0025 + 0.0052 * 0.0052, 1e-9);
  EXPECT_NEAR(match_covariance(information, 1.5)(0, 0), 0.04 + 0.0004, 1e-9);  // twice as wide
}

// Points of two walls along x seem to determine x if their normals are off by 3 degrees.
TEST_F(MatchGateTest, MatchesAlongABareCorridorDoNotAddUpToAPosition) {
  const double off_rad = 0.05;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information.diagonal() << 30'000.0 * off_rad * off_rad, 30'000.0, 90'000.0;
  information(1, 2) = information(2, 1) = 20'000.0;  // the walls lie ahead: heading and y together
  result_.covariance = match_covariance(information, doubt(result_));
  EXPECT_LT(std::sqrt(result_.covariance(0, 0)), 0.2);

  const Eigen::Matrix3d honest = honest_covariance(result_, MatchEvidence::kScan);
  EXPECT_GT(std::sqrt(honest(0, 0)), 4.0);
  EXPECT_NEAR(honest(1, 1), result_.covariance(1, 1), 1e-6);
  EXPECT_NEAR(honest(2, 2), result_.covariance(2, 2), 1e-6);
  EXPECT_EQ(Eigen::LLT<Eigen::Matrix3d>(honest).info(), Eigen::Success);
  EXPECT_EQ(honest_covariance(result_, MatchEvidence::kBranches), result_.covariance);
}

TEST_F(MatchGateTest, ARoomIsKnownAsWellAsItsMatchSays) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information.diagonal() << 10'000.0, 10'000.0, 90'000.0;
  result_.covariance = match_covariance(information, doubt(result_));
  const Eigen::Matrix3d honest = honest_covariance(result_, MatchEvidence::kScan);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(honest(i, i) / result_.covariance(i, i)), 1.0, 0.01) << i;
  }
}

TEST_F(MatchGateTest, ACovarianceBelowTheFloorStaysAsItIs) {
  result_.covariance.diagonal() << 1e-4, 1e-4, 1e-6;
  EXPECT_EQ(honest_covariance(result_, MatchEvidence::kScan), result_.covariance);
  result_.covariance.setZero();
  EXPECT_EQ(honest_covariance(result_, MatchEvidence::kScan), result_.covariance);
}

}  // namespace
}  // namespace topogeo::localization
