#include "place_search.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

const Eigen::Matrix3d kSharp = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();

/// One stop: places are proposed, each hypothesis is measured at its place or missed, and weighted.
void stop(PlaceSearch& search, const std::vector<Pose2>& places, const std::vector<bool>& seen,
          const std::vector<double>& fitness, double step_m = 1.0) {
  search.move({{step_m, 0.0, 0.0}, 1e-4 * Eigen::Matrix3d::Identity()}, step_m);
  search.propose(places);
  ASSERT_EQ(search.hypotheses().size(), seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    std::optional<PlaceSearch::Observation> measured;
    if (seen[i]) measured = {{search.hypotheses()[i].pose.T_a_b, kSharp}, true};
    search.observe(i, measured);
  }
  search.weigh(fitness);
  search.end_stop();
}

double sum_of_weights(const PlaceSearch& search) {
  double sum = 0.0;
  for (const PlaceHypothesis& hypothesis : search.hypotheses()) sum += hypothesis.weight;
  return sum;
}

TEST(PlaceSearch, BeginsWithoutAnything) {
  PlaceSearch search;
  EXPECT_FALSE(search.best());
  search.weigh({});
  EXPECT_TRUE(search.hypotheses().empty());
}

// New places weigh 0.05 each, elsewhere the rest of 0.5; a fitness of 0.7 against 0.6 elsewhere is
// worth e^2.5.
TEST(PlaceSearch, WeighsPlacesAgainstElsewhere) {
  PlaceSearch search;
  stop(search, {{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}}, {true, true}, {0.7, 0.6});
  const double a = 0.05 * std::exp(2.5);
  const double sum = 0.4 + a + 0.05;
  ASSERT_EQ(search.hypotheses().size(), 2U);
  EXPECT_NEAR(search.hypotheses()[0].weight, a / sum, 1e-9);
  EXPECT_NEAR(search.hypotheses()[1].weight, 0.05 / sum, 1e-9);
  EXPECT_NEAR(search.best()->weight, a / sum, 1e-9);
}

TEST(PlaceSearch, APlaceNearAHypothesisIsNoNewOne) {
  PlaceSearch search;
  search.propose(std::vector<Pose2>{{0.0, 0.0, 0.0}, {0.5, 0.0, 0.2}, {0.0, 0.0, 0.4}});
  EXPECT_EQ(search.hypotheses().size(), 2U);  // the third has another heading
}

TEST(PlaceSearch, HypothesesMoveWithTheRobot) {
  PlaceSearch search;
  search.propose(std::vector<Pose2>{{1.0, 2.0, 1.5707963267948966}});
  const double before = search.hypotheses()[0].pose.covariance(0, 0);
  search.move({{2.0, 0.0, 0.0}, 0.01 * Eigen::Matrix3d::Identity()}, 2.0);
  const PlaceHypothesis& moved = search.hypotheses()[0];
  EXPECT_NEAR(moved.pose.T_a_b.x_m, 1.0, 1e-12);
  EXPECT_NEAR(moved.pose.T_a_b.y_m, 4.0, 1e-12);
  EXPECT_GT(moved.pose.covariance(0, 0), before);
  EXPECT_EQ(moved.distance_m, 2.0);
}

TEST(PlaceSearch, IsDoneWhenOnePlaceIsSeenOftenEnoughAndFarEnoughApart) {
  PlaceSearch search;
  stop(search, {{0.0, 0.0, 0.0}}, {true}, {0.9});
  ASSERT_TRUE(search.best());
  EXPECT_GT(search.best()->weight, 0.95);
  EXPECT_FALSE(PlaceSearch::found(*search.best()));  // one view is not enough
  PlaceSearch standing = search;
  stop(standing, {}, {true}, {0.9}, 0.1);
  EXPECT_FALSE(PlaceSearch::found(*standing.best()));  // nor are two from the same place
  stop(search, {}, {true}, {0.9});
  EXPECT_EQ(search.best()->accepted, 2U);
  EXPECT_TRUE(PlaceSearch::found(*search.best()));
}

// Two views are enough at a reachable place; a place that the robot must have been carried to needs
// ten over 15 m.
TEST(PlaceSearch, APlaceToWhichTheDriveDoesNotLeadMustBeSeenOverALongPath) {
  PlaceSearch search;
  stop(search, {{0.0, 0.0, 0.0}}, {true}, {0.9});
  for (int i = 1; i < 10; ++i) stop(search, {}, {true}, {0.9}, 1.5);
  EXPECT_EQ(search.best()->accepted, 10U);
  EXPECT_TRUE(PlaceSearch::found(*search.best()));
  EXPECT_FALSE(PlaceSearch::found(*search.best(), 15.0));  // 13.5 m
  stop(search, {}, {true}, {0.9}, 1.5);
  EXPECT_TRUE(PlaceSearch::found(*search.best(), 15.0));
}

TEST(PlaceSearch, TheExpectedPlaceNeedsTwoLooksWheneverItComesUp) {
  PlaceSearch search;
  for (int i = 0; i < 5; ++i) search.end_stop();
  search.propose(std::vector<Pose2>{{0.0, 0.0, 0.0}, {20.0, 0.0, 0.0}});
  search.expect({20.2, 0.0, 0.0});
  search.expect({40.0, 0.0, 0.0});
  ASSERT_EQ(search.hypotheses().size(), 3U);
  EXPECT_EQ(search.hypotheses()[0].wanted, 4U);
  EXPECT_EQ(search.hypotheses()[1].wanted, 2U);
  EXPECT_EQ(search.hypotheses()[2].wanted, 2U);
}

// No match passes its gate, but each stop is at its expected place.
TEST(PlaceSearch, StopsThatAgreeProveAPlaceThatNoneProvesAlone) {
  const auto search_with = [](double fitness) {
    PlaceSearch search;
    search.begin();
    search.propose(std::vector<Pose2>{{0.0, 0.0, 0.0}});
    for (int i = 0; i < 4; ++i) {
      if (i > 0) search.move({{1.0, 0.0, 0.0}, 1e-4 * Eigen::Matrix3d::Identity()}, 1.0);
      const Pose2 here = search.hypotheses()[0].pose.T_a_b;
      search.observe(0, PlaceSearch::Observation{{here, kSharp}, false, 1.0});
      search.weigh(std::vector{fitness});
      EXPECT_EQ(PlaceSearch::found(*search.best()), i == 3 && fitness > 0.8);
    }
    return search;
  };
  EXPECT_EQ(search_with(0.85).best()->accepted, 0U);
  // Too little of the scan is in the map: a look-alike, however often it is seen.
  EXPECT_FALSE(PlaceSearch::found(*search_with(0.66).best()));
}

// A standing robot sees the same again, which is no further evidence.
TEST(PlaceSearch, StandingStillSharpensNothing) {
  PlaceSearch search;
  search.begin();
  stop(search, {{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}}, {true, true}, {0.7, 0.65});
  const auto ratio = [&] { return search.hypotheses()[0].weight / search.hypotheses()[1].weight; };
  const double before = ratio();
  for (int i = 0; i < 10; ++i) stop(search, {}, {true, true}, {0.7, 0.65}, 0.0);
  EXPECT_NEAR(ratio(), before, 1e-9);
  stop(search, {}, {true, true}, {0.7, 0.65});
  EXPECT_GT(ratio(), 2.0 * before);
}

TEST(PlaceSearch, APlaceThatComesUpLateMustBeSeenMoreOften) {
  PlaceSearch search;
  stop(search, {{0.0, 0.0, 0.0}}, {false}, {0.1});
  stop(search, {{30.0, 0.0, 0.0}}, std::vector<bool>(search.hypotheses().size() + 1, true),
       std::vector<double>(search.hypotheses().size() + 1, 0.9));
  const PlaceHypothesis& late = search.hypotheses().back();
  EXPECT_EQ(late.wanted, 3U);
}

TEST(PlaceSearch, HopelessPlacesAreDropped) {
  PlaceSearch search;
  stop(search, {{0.0, 0.0, 0.0}, {9.0, 0.0, 0.0}}, {true, true}, {0.9, 0.2});
  ASSERT_EQ(search.hypotheses().size(), 1U);  // 0.05 e^-10 is next to nothing
  stop(search, {}, {false}, {0.9});
  stop(search, {}, {false}, {0.9});
  EXPECT_EQ(search.best()->missed, 2U);
  EXPECT_FALSE(PlaceSearch::found(*search.best()));
  stop(search, {}, {false}, {0.9});
  EXPECT_TRUE(search.hypotheses().empty());  // missed three times in succession
}

TEST(PlaceSearch, TwoThatComeToTheSamePlaceAreOne) {
  PlaceSearch search;
  search.propose(std::vector<Pose2>{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
  search.observe(0, PlaceSearch::Observation{{{0.5, 0.0, 0.0}, kSharp}, true});
  search.observe(1, PlaceSearch::Observation{{{0.6, 0.0, 0.0}, kSharp}, true});
  search.weigh(std::vector{0.8, 0.8});
  EXPECT_EQ(search.hypotheses().size(), 1U);
  EXPECT_LE(sum_of_weights(search), 1.0);
}

TEST(PlaceSearch, AnotherSearchKnowsNothingOfTheLast) {
  PlaceSearch search;
  stop(search, {{0.0, 0.0, 0.0}}, {true}, {0.9});
  search.begin();
  EXPECT_TRUE(search.hypotheses().empty());
  search.propose(std::vector<Pose2>{{0.0, 0.0, 0.0}});
  EXPECT_EQ(search.hypotheses()[0].wanted, 2U);
}

TEST(PlaceSearch, RefusesWeightsForOtherPlaces) {
  PlaceSearch search;
  search.propose(std::vector<Pose2>{{0.0, 0.0, 0.0}});
  EXPECT_THROW(search.weigh({}), std::invalid_argument);
  EXPECT_THROW(search.observe(1, std::nullopt), std::out_of_range);
}

}  // namespace
}  // namespace topogeo::localization
