#include "topogeo/slam/state_monitor.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

constexpr std::size_t kPoints = 181;

StepMatch good(std::optional<std::size_t> step) {
  StepMatch match;
  match.verdict = Verdict::kAccepted;
  match.reason = Reason::kNone;
  match.doubt = 0.4;
  match.rivalry = 0.3;
  match.inliers = 0.95;
  match.expected_overlap = 0.8;
  match.matched_step = step;
  return match;
}

StepMatch refuted(std::optional<std::size_t> step) {
  StepMatch match;
  match.verdict = Verdict::kRejected;
  match.reason = Reason::kDoubtful;
  match.doubt = 5.0;
  match.rivalry = 0.9;
  match.inliers = 0.4;
  match.violations = 0.4;
  match.expected_overlap = 0.8;
  match.matched_step = step;
  return match;
}

StepEvidence step(std::vector<StepMatch> matches, double variance_m2 = 0.001) {
  StepEvidence evidence;
  evidence.matches = std::move(matches);
  evidence.points = kPoints;
  evidence.distance_m = 1.0;
  evidence.covariance = Eigen::Vector3d(variance_m2, variance_m2, 1e-4).asDiagonal();
  return evidence;
}

/// A robot that maps so many stops, each matched with the two before it.
void drive(StateMonitor& monitor, std::size_t stops) {
  for (std::size_t i = 0; i < stops; ++i) {
    std::vector<StepMatch> matches;
    for (std::size_t back = 1; back <= 2 && back <= monitor.steps(); ++back) {
      matches.push_back(good(monitor.steps() - back));
    }
    monitor.add(step(matches));
  }
}

TEST(StateMonitor, ALongDriveOfBelievedMatchesStaysTracking) {
  StateMonitor monitor;
  drive(monitor, 500);
  EXPECT_EQ(monitor.status().state, LocalizationState::kTracking);
  EXPECT_GT(monitor.status().confidence, 0.9);
}

TEST(StateMonitor, AKidnappedRobotIsLostWithinThreeStopsAndStaysSo) {
  StateMonitor monitor;
  drive(monitor, 20);
  monitor.add(step({refuted(19), refuted(18), refuted(17)}));
  EXPECT_NE(monitor.status().state, LocalizationState::kTracking);
  // The stops of the new place match each other perfectly.
  monitor.add(step({good(20), refuted(19), refuted(18)}));
  monitor.add(step({good(21), good(20), refuted(19)}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
  drive(monitor, 50);
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
  EXPECT_LT(monitor.status().confidence, 0.25);
  // The state lasts until it recognizes an earlier place.
  monitor.add(step({good(monitor.steps() - 1), good(5)}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kTracking);
}

TEST(StateMonitor, OneStopThatFitsNothingIsForgivenWhenTheNextOneFitsWhatWasBefore) {
  StateMonitor monitor;
  drive(monitor, 20);
  monitor.add(step({refuted(19), refuted(18)}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kAmbiguous);
  monitor.add(step({refuted(20), good(19)}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kTracking);
}

TEST(StateMonitor, ABlindedLaserLosesTheRobotWithinThreeStops) {
  StateMonitor monitor;
  drive(monitor, 20);
  StepEvidence blind = step({});
  blind.points = 0;
  for (int i = 0; i < 3; ++i) monitor.add(blind);
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
}

TEST(StateMonitor, OdometryAloneMakesItAmbiguousLongBeforeItIsLost) {
  StateMonitor monitor;
  drive(monitor, 5);
  for (int i = 1; i <= 10; ++i) {
    monitor.add(step({}, 0.01 * i));
    EXPECT_EQ(monitor.status().state, LocalizationState::kAmbiguous) << i;
  }
}

TEST(StateMonitor, AlongABareCorridorConfidenceFallsWithTheCovariance) {
  StateMonitor monitor;
  monitor.add(step({}));
  double last = monitor.status().confidence;
  for (int i = 1; i <= 20; ++i) {
    monitor.add(step({good(monitor.steps() - 1)}, 0.02 * i));
    EXPECT_LT(monitor.status().confidence, last);
    last = monitor.status().confidence;
  }
  EXPECT_EQ(monitor.status().state, LocalizationState::kAmbiguous);
}

TEST(StateMonitor, LittleInViewThatFitsContradictsNothing) {
  StepMatch little;
  little.reason = Reason::kLittleOverlap;
  little.inliers = 1.0;
  little.expected_overlap = 0.8;
  EXPECT_EQ(contradiction(step({little})), 0.0);
  little.violations = 0.06;
  EXPECT_NEAR(contradiction(step({little})), 0.5, 1e-12);
  little.inliers = 0.4;
  EXPECT_EQ(contradiction(step({little})), 1.0);
  StateMonitor monitor;
  drive(monitor, 20);
  little = StepMatch{};
  little.reason = Reason::kLittleOverlap;
  little.inliers = 0.97;
  little.expected_overlap = 0.8;
  for (int i = 0; i < 5; ++i) monitor.add(step({little}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kAmbiguous);
  EXPECT_GT(monitor.status().confidence, 0.8);
}

TEST(StateMonitor, AnInitialPoseRestartsIt) {
  StateMonitor monitor;
  drive(monitor, 3);
  for (int i = 0; i < 4; ++i) monitor.add(step({refuted(std::nullopt), refuted(std::nullopt)}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
  monitor.restart(0.9);
  monitor.add(step({}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kTracking);
  EXPECT_NEAR(monitor.status().confidence, 0.9, 0.05);
  // A pose that the scan contradicts is not accepted.
  monitor.restart(0.9);
  for (int i = 0; i < 2; ++i) monitor.add(step({refuted(std::nullopt), refuted(std::nullopt)}));
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
}

TEST(StateMonitor, MatchesThatFitDoNotHelpWhereAnotherPlaceFitsMuchBetter) {
  StateMonitor monitor;
  drive(monitor, 5);
  StepEvidence evidence = step({good(std::nullopt)});
  evidence.better_elsewhere = 0.3;
  for (int i = 0; i < 2; ++i) monitor.add(evidence);
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
}

TEST(StateMonitor, AMatchWithAStepToComeIsAnError) {
  StateMonitor monitor;
  monitor.add(step({}));
  EXPECT_THROW(monitor.add(step({good(1)})), std::invalid_argument);
}

TEST(CovarianceConfidence, IsTheShareWithinTheLimits) {
  // 0.3 m is 1 standard deviation of each axis: 1 - e^-1/2; 5 degrees are 1.96 of them: 0.95.
  const Eigen::Matrix3d c = Eigen::Vector3d(0.09, 0.09, 0.0019824).asDiagonal();
  EXPECT_NEAR(covariance_confidence(c), 0.3935 * 0.95, 2e-3);
  EXPECT_NEAR(covariance_confidence(Eigen::Matrix3d::Zero()), 1.0, 1e-3);
}

// The drive's own stops confirm the pose, but the map contradicts it: the map outweighs them in a
// few stops; a changed corner of the map does not.
TEST(StateMonitor, AMapThatContradictsOutweighsTheStopsOfADrive) {
  StateMonitor monitor;
  monitor.add(step({good(std::nullopt)}));
  const auto follow = [&](const StepMatch& with_map) {
    StepMatch own = good(monitor.steps() - 1);
    own.expected_overlap = 0.0;  // always a match to expect
    monitor.add(step({own, with_map}));
  };
  follow(refuted(std::nullopt));
  EXPECT_GT(monitor.status().confidence, 0.5);
  StateMonitor corner = monitor;
  corner.add(step({good(corner.steps() - 1), good(std::nullopt)}));
  EXPECT_EQ(corner.status().state, LocalizationState::kTracking);
  for (int i = 0; i < 6; ++i) follow(refuted(std::nullopt));
  EXPECT_EQ(monitor.status().state, LocalizationState::kLost);
}

}  // namespace
}  // namespace topogeo::localization
