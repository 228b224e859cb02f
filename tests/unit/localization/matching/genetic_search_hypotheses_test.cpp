#include "genetic_search_hypotheses.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "genetic_search.hpp"
#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

std::vector<Pose2> hypotheses(const MatchTask& task, const MatchFeatures& reference,
                              const MatchFeatures& query) {
  BranchHypotheses finder;
  const auto found = finder.find(task, reference, query);
  return {found.begin(), found.end()};
}

MatchTask widest_task() {
  MatchTask task;
  task.T_reference_query = {0.5, 0.5, 0.0};
  task.half_width = {3.0, 3.0, 1.0};
  task.genetic.branch_hypotheses = 10;
  return task;
}

// A corridor along x that widens, with a branch to the left at x = 4; the query sees it from a
// place 2 m on, 1 m aside and turned.
MatchFeatures junction(const Pose2& T_map_robot) {
  MatchFeatures features;
  const Pose2 T_robot_map = geometry::inverse(T_map_robot);
  const auto add = [&](double x, double y, double direction_rad, double clearance_m) {
    BranchSample sample = test::sample(x, y, direction_rad, clearance_m);
    sample.position_m = T_robot_map * sample.position_m;
    sample.direction = Pose2{0, 0, T_robot_map.theta_rad} * sample.direction;
    features.branches.push_back(sample);
  };
  for (int i = 0; i < 40; ++i) add(0.2 * i, 0.0, 0.0, 0.6 + 0.05 * i);
  for (int i = 0; i < 15; ++i) add(4.0, 0.2 * i, 90.0 * kDegree, 0.5);
  return features;
}

TEST(BranchHypothesesTest, LayOneMapOnTheOther) {
  const Pose2 truth{2.0, 1.0, 0.5};
  const std::vector<Pose2> found = hypotheses(widest_task(), junction({}), junction(truth));
  ASSERT_FALSE(found.empty());
  EXPECT_LT(test::distance_m(found.front(), truth), 0.25);
  EXPECT_LT(test::turn_rad(found.front(), truth), 3.0 * kDegree);
}

TEST(BranchHypothesesTest, LieInTheSpaceAreDistinctAndNotTooMany) {
  const world::World floor = test::world("floor");
  const MatchFeatures reference = extract_features(test::map_at(floor, {8.6, 1.2, 0.1}, 0));
  const MatchFeatures query = extract_features(test::map_at(floor, {9.4, 1.2, 0.5}, 1));
  for (const std::uint32_t wanted : {1U, 5U, 40U}) {
    MatchTask task = widest_task();
    task.genetic.branch_hypotheses = wanted;
    const std::vector<Pose2> found = hypotheses(task, reference, query);
    EXPECT_LE(found.size(), wanted);
    EXPECT_FALSE(found.empty());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(in_search_space(task, found[i])) << i;
      for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(same_solution(task, found[i], found[k]));
    }
    EXPECT_EQ(found, hypotheses(task, reference, query));
  }
}

TEST(BranchHypothesesTest, ANodeIsLaidOnOneOfLikeClearanceWithThePredictedHeading) {
  MatchFeatures reference;
  reference.nodes = {test::node(2.0, 1.0, 0.8), test::node(0.5, 0.5, 2.0)};
  MatchFeatures query;
  query.nodes = {test::node(1.0, 0.0, 0.85)};
  MatchTask task = widest_task();
  task.T_reference_query.theta_rad = 90.0 * kDegree;
  const std::vector<Pose2> found = hypotheses(task, reference, query);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].x_m, 2.0, 1e-9);  // (1, 0) turned by 90 degrees is (0, 1)
  EXPECT_NEAR(found[0].y_m, 0.0, 1e-9);
  EXPECT_NEAR(found[0].theta_rad, 90.0 * kDegree, 1e-9);
}

TEST(BranchHypothesesTest, ABranchHasTwoDirections) {
  MatchFeatures reference;
  reference.branches = {test::sample(0.5, 0.5, 0.0, 1.0)};
  MatchFeatures query;
  query.branches = {test::sample(0.0, 0.0, 0.3, 1.1)};
  MatchTask task = widest_task();
  std::vector<Pose2> found = hypotheses(task, reference, query);
  ASSERT_EQ(found.size(), 1U) << "half a turn is not in the space";
  EXPECT_NEAR(found[0].theta_rad, -0.3, 1e-9);
  task.half_width.z() = 3.2;
  found = hypotheses(task, reference, query);
  EXPECT_EQ(found.size(), 2U);
}

TEST(BranchHypothesesTest, NoneWithoutEquivalentsOrWhenNoneAreWanted) {
  EXPECT_TRUE(hypotheses(widest_task(), {}, {}).empty());
  EXPECT_TRUE(hypotheses(widest_task(), junction({}), {}).empty());
  EXPECT_TRUE(hypotheses(widest_task(), {}, junction({})).empty());
  MatchTask task = widest_task();
  task.genetic.branch_hypotheses = 0;
  EXPECT_TRUE(hypotheses(task, junction({}), junction({})).empty());
  task = widest_task();
  task.T_reference_query = {100.0, 0.0, 0.0};
  EXPECT_TRUE(hypotheses(task, junction({}), junction({})).empty());
}

// Maps of thousands of samples are thinned, not refused.
TEST(BranchHypothesesTest, LargeMapsAreThinned) {
  MatchFeatures large;
  for (int i = 0; i < 3000; ++i) large.branches.push_back(test::sample(0.002 * i, 0, 0, 1.0));
  EXPECT_FALSE(hypotheses(widest_task(), large, large).empty());
}

}  // namespace
}  // namespace topogeo::localization
