#include "continued_place.hpp"

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

Eigen::Matrix3d step_spread(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

DriveStep step(bool matched) {
  DriveStep step;
  step.T_before_now = {{1.0, 0.0, 0.0}, step_spread(0.02, 0.005)};
  step.distance_m = 1.0;
  step.matched = matched;
  return step;
}

/// A step whose match was rejected by the gate for this reason.
DriveStep unmatched(Reason reason) {
  DriveStep without = step(false);
  MatchTask task;
  task.T_reference_query = {1.0, 0.0, 0.0};
  task.covariance = step_spread(0.1, 0.05);
  MatchResult result;
  result.T_reference_query = {1.0, 0.0, 0.0};
  result.covariance = step_spread(0.03, 0.01);
  result.verdict = Verdict::kRejected;
  result.reason = reason;
  result.overlap = 0.8;
  result.inliers = 0.8;
  result.fitness = 0.7;
  without.match = {task, result};
  return without;
}

const UncertainPose kTracked{{2.0, 3.0, 0.0}, step_spread(0.05, 0.01)};

TEST(ContinuedPlace, LeadsAnywhereWhereNothingIsKnown) {
  ContinuedPlace place;
  EXPECT_FALSE(place.pose());
  EXPECT_TRUE(place.leads_to({{50.0, 0.0, 0.0}, step_spread(0.1, 0.02)}));
  place.move(step(true));
  EXPECT_FALSE(place.pose());
}

TEST(ContinuedPlace, GoesOnByMatchedSteps) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  for (int i = 0; i < 4; ++i) place.move(step(true));
  ASSERT_TRUE(place.pose());
  EXPECT_NEAR(place.pose()->T_a_b.x_m, 6.0, 1e-12);
  EXPECT_TRUE(place.leads_to({{6.3, 3.2, 0.05}, step_spread(0.1, 0.02)}));
  EXPECT_FALSE(place.leads_to({{6.0, 9.0, 0.0}, step_spread(0.1, 0.02)}));   // the next office
  EXPECT_FALSE(place.leads_to({{6.0, 3.0, 1.57}, step_spread(0.1, 0.02)}));  // other heading
}

TEST(ContinuedPlace, KnowsTheLessTheFurtherItWent) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  for (int i = 0; i < 100; ++i) place.move(step(true));
  EXPECT_TRUE(place.leads_to({{102.0, 8.0, 0.0}, step_spread(0.1, 0.02)}));
}

TEST(ContinuedPlace, AStepThatMayHaveCarriedTheRobotEndsIt) {
  for (const Reason reason : {Reason::kFewInliers, Reason::kNothingInCommon}) {
    ContinuedPlace place;
    place.track(kTracked, 1.0);
    place.move(unmatched(reason));
    EXPECT_FALSE(place.pose());
  }
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  place.move(step(false));  // nothing to match it with
  EXPECT_FALSE(place.pose());
}

TEST(ContinuedPlace, ADoubtfulStepThatMayBeRightDoesNot) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  place.move(unmatched(Reason::kDoubtful));
  EXPECT_TRUE(place.pose());
}

TEST(ContinuedPlace, WantsTwiceAsMuchOfWhatItContradicts) {
  const UncertainPose elsewhere{{40.0, 0.0, 0.0}, step_spread(0.1, 0.02)};
  ContinuedPlace place;
  EXPECT_EQ(place.wanted_m(elsewhere), 0.0);
  place.track(kTracked, 1.0);
  EXPECT_EQ(place.wanted_m(kTracked), 0.0);
  EXPECT_EQ(place.wanted_m(elsewhere), 15.0);
  for (int i = 0; i < 11; ++i) place.track(kTracked, 1.0);
  EXPECT_EQ(place.wanted_m(elsewhere), 24.0);
  for (int i = 0; i < 20; ++i) place.track(kTracked, 1.0);
  EXPECT_EQ(place.wanted_m(elsewhere), 40.0);
  place.move(step(false));
  EXPECT_EQ(place.wanted_m(elsewhere), 0.0);
  place.track(kTracked, 1.0);  // the true place all along
  EXPECT_EQ(place.wanted_m(elsewhere), 40.0);
  place.forget();
  place.track(kTracked, 1.0);
  EXPECT_EQ(place.wanted_m(elsewhere), 15.0);
}

TEST(ContinuedPlace, EndsWhereTheMapContradictsWhatIsSeen) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  place.compare({0.4, 0.2}, 1.0);
  EXPECT_TRUE(place.pose());  // one scan, and not all of it known
  place.compare({0.5, 0.1}, 1.0);
  EXPECT_FALSE(place.pose());
}

/// Whether a place is still known after so many scans with this view, each so far after the last.
bool goes_on(const KnownView& view, double distance_m, int scans) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  for (int i = 0; i < scans; ++i) place.compare(view, distance_m);
  return place.pose().has_value();
}

TEST(ContinuedPlace, GoesOnWhereTheMapKnowsNothing) {
  EXPECT_TRUE(goes_on({0.0, 0.01}, 1.0, 50));
}

TEST(ContinuedPlace, GoesOnWhereDoorsAndPeopleHaveChanged) {
  EXPECT_TRUE(goes_on({0.75, 0.15}, 1.0, 50));
}

TEST(ContinuedPlace, CountsAViewOnce) {
  EXPECT_TRUE(goes_on({0.4, 0.2}, 0.1, 4));
}

TEST(ContinuedPlace, BeginsAnewWhereItIsTracked) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  place.compare({0.4, 0.2}, 1.0);
  place.track(kTracked, 1.0);
  place.compare({0.4, 0.2}, 1.0);
  EXPECT_TRUE(place.pose());
}

TEST(ContinuedPlace, ForgetsWhenItIsTold) {
  ContinuedPlace place;
  place.track(kTracked, 1.0);
  place.forget();
  EXPECT_FALSE(place.pose());
}

}  // namespace
}  // namespace topogeo::localization
