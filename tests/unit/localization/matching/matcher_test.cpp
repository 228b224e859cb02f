#include "topogeo/matching/matcher.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/matching/match_gate.hpp"

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

void expect_same(const MatchResult& a, const MatchResult& b) {
  EXPECT_EQ(a.task_id, b.task_id);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.T_reference_query, b.T_reference_query);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.overlap, b.overlap);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.violations, b.violations);
  EXPECT_EQ(a.residual_rms_m, b.residual_rms_m);
  EXPECT_EQ(a.fitness, b.fitness);
  EXPECT_EQ(a.second.fitness, b.second.fitness);
  EXPECT_EQ(a.second.T_reference_query, b.second.T_reference_query);
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.reason, b.reason);
  ASSERT_EQ(a.solutions.size(), b.solutions.size());
  for (std::size_t i = 0; i < a.solutions.size(); ++i) {
    EXPECT_EQ(a.solutions[i].T_reference_query, b.solutions[i].T_reference_query);
    EXPECT_EQ(a.solutions[i].fitness, b.solutions[i].fitness);
  }
}

struct Pair {
  std::string world;
  Pose2 T_world_reference;
  Pose2 T_world_query;
  double error_m;     ///< limit; in a bare corridor the width of the prediction
  bool bare = false;  ///< a bare corridor: it looks the same half a metre on
};

std::ostream& operator<<(std::ostream& out, const Pair& pair) {
  return out << pair.world << " " << pair.T_world_reference.x_m << " "
             << pair.T_world_reference.y_m;
}

class TrueRelativePoseTest : public testing::TestWithParam<Pair> {};

TEST_P(TrueRelativePoseTest, IsFoundFromAPredictionThatIsOff) {
  const Pair& pair = GetParam();
  const world::World world = test::world(pair.world);
  const topomap::LocalMap reference = test::map_at(world, pair.T_world_reference, 3);
  const topomap::LocalMap query = test::map_at(world, pair.T_world_query, 8);
  const Pose2 truth = geometry::between(pair.T_world_reference, pair.T_world_query);
  Matcher matcher;
  matcher.add_map(reference);
  matcher.add_map(query);
  for (const Pose2& off :
       {Pose2{0.2, -0.1, 0.15}, Pose2{-0.15, 0.2, -0.15}, Pose2{0.1, 0.2, 0.1}}) {
    const MatchTask task = test::task_between(
        reference, query,
        {truth.x_m + off.x_m, truth.y_m + off.y_m, truth.theta_rad + off.theta_rad}, 0.2, 0.15);
    const MatchResult result = matcher.solve(task);
    EXPECT_EQ(result.status, MatchStatus::kSolved);
    EXPECT_LT(test::distance_m(result.T_reference_query, truth), pair.error_m);
    EXPECT_LT(test::turn_rad(result.T_reference_query, truth), 0.6 * kDegree);
    const bool accepted = result.verdict == Verdict::kAccepted ||
                          (pair.bare && result.verdict == Verdict::kAmbiguous);
    EXPECT_TRUE(accepted) << to_string(result.reason) << " " << doubt(result);
    const Pose2& T = result.T_reference_query;
    const Eigen::Vector3d error(T.x_m - truth.x_m, T.y_m - truth.y_m,
                                geometry::wrap_angle(T.theta_rad - truth.theta_rad));
    // The covariance must cover the error, also along the corridor.
    EXPECT_LT(error.dot(result.covariance.inverse() * error), 11.3);
    EXPECT_EQ(result.task_id, task.task_id);
    EXPECT_EQ(result.evaluations, 50U + 29U * 48U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Places, TrueRelativePoseTest,
    testing::Values(Pair{"room", {1.0, 1.0, 0.2}, {1.6, 1.1, 0.5}, 0.04},
                    Pair{"room", {4.6, 3.0, 3.0}, {4.0, 2.9, -3.1}, 0.04},
                    Pair{"floor", {8.6, 1.2, 0.1}, {9.1, 1.2, 0.4}, 0.04},
                    Pair{"floor", {15.0, 10.5, 1.5}, {15.0, 11.3, 1.7}, 0.04},
                    Pair{"floor", {28.9, 9.0, 1.6}, {28.9, 9.8, 1.4}, 0.3, true}),
    [](const auto& place) { return place.param.world + std::to_string(place.index); });

class MatcherTest : public testing::Test {
 protected:
  MatcherTest() {
    const world::World floor = test::world("floor");
    for (std::uint32_t id = 0; id < 8; ++id) {
      maps_.push_back(test::map_at(floor, {6.0 + 0.6 * id, 1.2, 0.05 * id}, id));
      matcher_.add_map(maps_.back());
    }
    task_ = task(0, 1);
  }
  MatchTask task(std::size_t reference, std::size_t query) const {
    return test::task_between(
        maps_[reference], maps_[query],
        geometry::between(maps_[reference].T_odom_robot, maps_[query].T_odom_robot), 0.15, 0.1);
  }

  std::vector<topomap::LocalMap> maps_;
  Matcher matcher_;
  MatchTask task_;
};

TEST_F(MatcherTest, RefusesMapsThatItDoesNotHave) {
  task_.reference_map_id = 77;
  EXPECT_THROW(matcher_.solve(task_), std::out_of_range);
  task_ = task(0, 1);
  task_.query_map_id = 77;
  EXPECT_THROW(matcher_.solve(task_), std::out_of_range);
  task_ = task(0, 1);
  ++task_.query_hash;
  EXPECT_THROW(matcher_.solve(task_), std::out_of_range);
  task_ = task(0, 1);
  ++task_.reference_hash;
  EXPECT_THROW(matcher_.solve(task_), std::out_of_range);
}

TEST_F(MatcherTest, RefusesTasksThatMakeNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<std::string, std::function<void(MatchTask&)>>> faults{
      {"no covariance", [](MatchTask& t) { t.covariance.setZero(); }},
      {"a negative variance", [](MatchTask& t) { t.covariance(1, 1) = -1.0; }},
      {"covariance nan", [&](MatchTask& t) { t.covariance(0, 1) = nan; }},
      {"covariance infinite", [&](MatchTask& t) { t.covariance(0, 0) = infinite; }},
      // Two negative eigenvalues, yet a positive diagonal and determinant.
      {"indefinite",
       [](MatchTask& t) {
         t.covariance = Eigen::Matrix3d::Constant(11.0 / 3.0) - Eigen::Matrix3d::Identity();
       }},
      {"empty space", [](MatchTask& t) { t.half_width.y() = 0.0; }},
      {"space nan", [&](MatchTask& t) { t.half_width.x() = nan; }},
      {"space infinite", [&](MatchTask& t) { t.half_width.z() = infinite; }},
      {"pose nan", [&](MatchTask& t) { t.T_reference_query.theta_rad = nan; }},
      {"no resolution", [](MatchTask& t) { t.genetic.resolution_m = 0.0; }},
      {"resolution nan", [&](MatchTask& t) { t.genetic.resolution_rad = nan; }},
      {"three individuals", [](MatchTask& t) { t.genetic.individuals = 3; }},
      {"individuals without end", [](MatchTask& t) { t.genetic.individuals = 10'001; }},
      {"no generation", [](MatchTask& t) { t.genetic.generations = 0; }},
      {"hours of work", [](MatchTask& t) { t.genetic.generations = 20'001; }},
      {"crossover rate", [](MatchTask& t) { t.genetic.crossover_rate = 1.01; }},
      {"crossover rate negative", [](MatchTask& t) { t.genetic.crossover_rate = -0.01; }},
      {"crossover rate nan", [&](MatchTask& t) { t.genetic.crossover_rate = nan; }},
      {"mutation rate", [](MatchTask& t) { t.genetic.mutation_rate = 0.51; }},
      {"mutation rate negative", [](MatchTask& t) { t.genetic.mutation_rate = -0.01; }},
      {"mutation rate nan", [&](MatchTask& t) { t.genetic.mutation_rate = nan; }},
      {"no elite", [](MatchTask& t) { t.genetic.elite = 0; }},
      {"all elite", [](MatchTask& t) { t.genetic.elite = 50; }},
      {"hypotheses", [](MatchTask& t) { t.genetic.branch_hypotheses = 10'001; }},
      {"initial individual nan",
       [&](MatchTask& t) {
         t.initial_individuals = {{0, nan, 0}};
       }},
      {"initial individual heading",
       [](MatchTask& t) {
         t.initial_individuals = {{0, 0, 1e9}};
       }},
      {"gate nan", [&](MatchTask& t) { t.gate.largest_doubt = nan; }},
      {"gate negative", [](MatchTask& t) { t.gate.smallest_overlap = -0.1; }},
      {"form", [](MatchTask& t) { t.fitness_form = static_cast<FitnessForm>(4); }},
      {"space", [](MatchTask& t) { t.half_width.x() = 1e9; }},
      {"pose far", [](MatchTask& t) { t.T_reference_query.x_m = 1e30; }},
      {"no solutions", [](MatchTask& t) { t.solutions_wanted = 0; }},
      {"too many solutions", [](MatchTask& t) { t.solutions_wanted = 41; }},
  };
  for (const auto& [name, spoil] : faults) {
    MatchTask spoilt = task_;
    spoil(spoilt);
    EXPECT_THROW(matcher_.solve(spoilt), std::invalid_argument) << name;
  }
  EXPECT_NO_THROW(matcher_.solve(task_));
}

TEST_F(MatcherTest, AnswersTheSameAgainAndAfterItsCacheWasFilledWithOthers) {
  const MatchResult first = matcher_.solve(task_);
  ASSERT_EQ(first.status, MatchStatus::kSolved);
  expect_same(first, matcher_.solve(task_));
  for (std::size_t i = 0; i < Matcher::kKeptReferences; ++i) {
    topomap::LocalMap another = maps_[2 + i % 4];
    another.id = static_cast<std::uint32_t>(100 + i);
    matcher_.add_map(another);
    MatchTask on_another = task_;
    on_another.reference_map_id = another.id;
    on_another.reference_hash = topomap::content_hash(another);
    matcher_.solve(on_another);
  }
  expect_same(first, matcher_.solve(task_));
  Matcher other;
  other.add_map(maps_[1]);
  other.add_map(maps_[0]);
  expect_same(first, other.solve(task_));
}

TEST_F(MatcherTest, ALaterMapOfTheSameIdReplacesTheEarlierOne) {
  const MatchResult before = matcher_.solve(task_);
  topomap::LocalMap changed = test::map_at(test::world("floor"), {6.3, 1.0, 0.0}, 0);
  matcher_.add_map(changed);
  EXPECT_FALSE(matcher_.has_map(0, task_.reference_hash));
  EXPECT_TRUE(matcher_.has_map(0, topomap::content_hash(changed)));
  EXPECT_FALSE(matcher_.has_map(99, task_.reference_hash));
  EXPECT_THROW(matcher_.solve(task_), std::out_of_range);
  task_.reference_hash = topomap::content_hash(changed);
  const MatchResult after = matcher_.solve(task_);
  EXPECT_NEAR(after.T_reference_query.x_m, 0.3, 0.04);
  EXPECT_NE(before.T_reference_query, after.T_reference_query);
}

TEST_F(MatcherTest, SaysWhenNothingIsInCommon) {
  task_.T_reference_query = {60.0, 0.0, 0.0};
  const MatchResult result = matcher_.solve(task_);
  EXPECT_EQ(result.status, MatchStatus::kNothingInCommon);
  EXPECT_EQ(result.task_id, task_.task_id);
  EXPECT_EQ(result.overlap, 0.0);
  EXPECT_TRUE(result.covariance.isZero());
  EXPECT_EQ(result.reason, Reason::kNothingInCommon);
}

TEST_F(MatcherTest, AMapWithoutPointsIsNoError) {
  topomap::LocalMap blind;
  blind.robot_id = "robot";
  blind.id = 20;
  matcher_.add_map(blind);
  for (const auto& [reference, query] :
       {std::pair{&maps_[0], &blind}, std::pair{&blind, &maps_[0]}, std::pair{&blind, &blind}}) {
    EXPECT_EQ(matcher_.solve(test::task_between(*reference, *query, {}, 0.1, 0.1)).status,
              MatchStatus::kNothingInCommon);
  }
}

TEST_F(MatcherTest, ThePoolAnswersInTheOrderOfTheTasks) {
  InProcessPool pool;
  for (const auto& map : maps_) pool.add_map(std::make_shared<const topomap::LocalMap>(map));
  std::vector<MatchTask> tasks;
  for (const std::size_t i : {5U, 0U, 3U, 2U}) {
    tasks.push_back(task(i, i + 1));
    tasks.back().task_id = 100 + i;
  }
  const std::vector<MatchResult> results = pool.match(tasks);
  ASSERT_EQ(results.size(), tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) expect_same(results[i], matcher_.solve(tasks[i]));
  EXPECT_TRUE(pool.match({}).empty());
}

}  // namespace
}  // namespace topogeo::localization
