// Stops without scans, so that no overlap is predicted; a pool with scripted answers shows the
// tasks and the handling of their results. pose_graph_slam_test.cpp has drives with scans.
#include "stop_matching.hpp"

#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

class AnsweringPool : public MatchPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> /*map*/) override {}
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override {
    std::vector<MatchResult> results;
    for (const MatchTask& task : tasks) {
      asked.push_back(task);
      results.push_back(answer(task));
      results.back().task_id = task.task_id;
    }
    return results;
  }
  std::vector<MatchTask> asked;
  std::function<MatchResult(const MatchTask&)> answer = [](const MatchTask&) {
    return MatchResult{};
  };
};

MatchResult found(const Pose2& T_reference_query, Verdict verdict, Reason reason) {
  MatchResult result;
  result.status = MatchStatus::kSolved;
  result.T_reference_query = T_reference_query;
  result.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  result.fitness = 0.8;
  result.verdict = verdict;
  result.reason = reason;
  result.solutions = {{T_reference_query, 0.8}};
  return result;
}

class StopMatchingTest : public ::testing::Test {
 protected:
  void add_stop(double step_m = 1.0) {
    auto map = std::make_shared<topomap::LocalMap>();
    map->robot_id = "robot";
    map->id = static_cast<std::uint32_t>(matching_.size());
    map->T_previous_robot = {step_m, 0.0, 0.0};
    matching_.add(map, step_m);
    if (graph_.poses().empty()) {
      graph_.add_pose({});
      return;
    }
    const std::uint32_t stop = graph_.add_pose(graph_.poses().back() * Pose2{step_m, 0.0, 0.0});
    graph_.add_edge({stop - 1,
                     stop,
                     EdgeKind::kOdometry,
                     {step_m, 0.0, 0.0},
                     Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  }

  AnsweringPool pool_;
  StopMatching matching_{LocalizerConfig{}, pool_};
  PoseGraph graph_;
};

TEST_F(StopMatchingTest, TheStopBeforeIsMatchedInAnyCase) {
  add_stop();
  add_stop();
  pool_.answer = [](const MatchTask& task) {
    return found(task.T_reference_query, Verdict::kAccepted, Reason::kNone);
  };
  const std::vector<StopMatch> matches = matching_.match_recent(graph_);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_TRUE(matches[0].accepted());
  EXPECT_EQ(matches[0].edge.from, 0U);
  EXPECT_EQ(matches[0].edge.to, 1U);
  EXPECT_EQ(matches[0].edge.kind, EdgeKind::kSequential);
  EXPECT_NEAR(matches[0].edge.T_from_to.x_m, 1.0, 1e-9);
  EXPECT_EQ(matches[0].evidence.matched_step, 0U);
  ASSERT_EQ(pool_.asked.size(), 1U);
  EXPECT_EQ(pool_.asked[0].reference_map_id, 1U);
  EXPECT_NEAR(pool_.asked[0].T_reference_query.x_m, -1.0, 1e-12);
  EXPECT_EQ(pool_.asked[0].initial_individuals.size(), 1U);  // from the scan tracker
}

TEST_F(StopMatchingTest, WithoutSuccessItSearchesOnceMoreInAWiderSpace) {
  add_stop();
  add_stop();
  const std::vector<StopMatch> matches = matching_.match_recent(graph_);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_FALSE(matches[0].accepted());
  EXPECT_FALSE(matches[0].uncertain());
  ASSERT_EQ(pool_.asked.size(), 2U);
  EXPECT_TRUE(pool_.asked[1].covariance.isApprox(9.0 * pool_.asked[0].covariance));
  EXPECT_EQ(matching_.requests().counts().tasks, 2U);
}

TEST_F(StopMatchingTest, TheNextSearchStartsFromTheSolutionsOfTheLast) {
  add_stop();
  add_stop();
  pool_.answer = [](const MatchTask& task) {
    return found(task.T_reference_query, Verdict::kAmbiguous, Reason::kSecondSolution);
  };
  const std::vector<StopMatch> first = matching_.match_recent(graph_);
  EXPECT_TRUE(first[0].uncertain());
  add_stop();
  pool_.asked.clear();
  matching_.match_recent(graph_);
  // Only the previous stop is compared, for which nothing was solved yet.
  ASSERT_FALSE(pool_.asked.empty());
  EXPECT_EQ(pool_.asked[0].query_map_id, 1U);
  EXPECT_EQ(pool_.asked[0].initial_individuals.size(), 1U);
}

TEST_F(StopMatchingTest, ADistanceLikeAGapLeavesNothingRecent) {
  add_stop();
  add_stop(100.0);
  EXPECT_EQ(matching_.path_m(1), 100.0);
  EXPECT_TRUE(matching_.match_recent(graph_).empty());
  EXPECT_TRUE(pool_.asked.empty());
}

TEST_F(StopMatchingTest, WithoutForeseenOverlapNothingIsRevisited) {
  for (int i = 0; i < 12; ++i) add_stop();
  const std::vector<std::uint32_t> stops{11};
  EXPECT_TRUE(matching_.match_revisited(graph_, stops).empty());
  EXPECT_TRUE(pool_.asked.empty());
}

}  // namespace
}  // namespace topogeo::localization
