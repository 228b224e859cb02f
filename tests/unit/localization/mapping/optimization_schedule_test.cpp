#include "optimization_schedule.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Records its problems; a flag decides whether results are usable.
class FakeOptimizer : public GraphOptimizer {
 public:
  void start(GraphProblem problem) override { problems.push_back(std::move(problem)); }
  GraphSolution fetch() override {
    ++fetched;
    GraphSolution solution;
    solution.summary.usable = usable;
    solution.strained = strained;
    solution.stops = problems.back().stops;
    return solution;
  }
  std::vector<GraphProblem> problems;
  int fetched = 0;
  bool usable = true;
  bool strained = false;
};

PoseGraph two_stops() {
  PoseGraph graph;
  graph.add_pose({});
  graph.add_pose({1.0, 0.0, 0.0});
  graph.add_edge({0, 1, EdgeKind::kOdometry, {1.0, 0.0, 0.0}});
  return graph;
}

const PoseGraphEdge kLoop{0, 1, EdgeKind::kRevisit, {1.1, 0.0, 0.0}};

TEST(OptimizationSchedule, NothingStartsUnlessItIsWanted) {
  FakeOptimizer optimizer;
  OptimizationSchedule schedule(&optimizer, 2);
  schedule.start(5, two_stops(), {});
  EXPECT_TRUE(optimizer.problems.empty());
  EXPECT_FALSE(schedule.fetch(100));
  EXPECT_FALSE(schedule.fetch_now());
}

TEST(OptimizationSchedule, AResultIsDueSoManyStepsAfterItsStart) {
  FakeOptimizer optimizer;
  OptimizationSchedule schedule(&optimizer, 2);
  schedule.want();
  const std::vector loops{kLoop};
  schedule.start(5, two_stops(), loops);
  ASSERT_EQ(optimizer.problems.size(), 1U);
  EXPECT_EQ(optimizer.problems[0].T_map_robot.size(), 2U);
  ASSERT_EQ(optimizer.problems[0].edges.size(), 2U);  // one of the graph, then the loop
  EXPECT_EQ(optimizer.problems[0].edges[1].kind, EdgeKind::kRevisit);
  EXPECT_FALSE(schedule.fetch(6));
  EXPECT_EQ(optimizer.fetched, 0);
  const auto finished = schedule.fetch(7);
  ASSERT_TRUE(finished);
  EXPECT_EQ(finished->loops, 1U);
  EXPECT_FALSE(schedule.fetch(8));
  EXPECT_EQ(schedule.optimizations(), 1U);
  EXPECT_EQ(schedule.failed(), 0U);
}

TEST(OptimizationSchedule, OneAtATimeAndTheNextWhenItHasEnded) {
  FakeOptimizer optimizer;
  OptimizationSchedule schedule(&optimizer, 3);
  schedule.want();
  schedule.start(0, two_stops(), {});
  schedule.want();
  schedule.start(1, two_stops(), {});
  EXPECT_EQ(optimizer.problems.size(), 1U);
  EXPECT_TRUE(schedule.fetch_now());  // not due before 3
  schedule.start(2, two_stops(), {});
  EXPECT_EQ(optimizer.problems.size(), 2U);
  EXPECT_FALSE(schedule.fetch(4));
  EXPECT_TRUE(schedule.fetch(5));
}

TEST(OptimizationSchedule, TenSmallLoopsAreWorthOne) {
  FakeOptimizer optimizer;
  OptimizationSchedule schedule(&optimizer, 0);
  for (int i = 0; i < 9; ++i) schedule.count_loop(kLoop);
  schedule.start(0, two_stops(), {});
  EXPECT_TRUE(optimizer.problems.empty());
  schedule.count_loop(kLoop);
  schedule.start(1, two_stops(), {});
  EXPECT_EQ(optimizer.problems.size(), 1U);
  EXPECT_TRUE(schedule.fetch(1));
  schedule.count_loop(kLoop);  // counting starts again
  schedule.start(2, two_stops(), {});
  EXPECT_EQ(optimizer.problems.size(), 1U);
}

TEST(OptimizationSchedule, CountsResultsThatAreOfNoUse) {
  FakeOptimizer optimizer;
  optimizer.usable = false;
  OptimizationSchedule schedule(&optimizer, 0);
  schedule.want();
  schedule.start(0, two_stops(), {});
  ASSERT_TRUE(schedule.fetch(0));
  EXPECT_EQ(schedule.failed(), 1U);
}

TEST(OptimizationSchedule, WithoutAnOptimizerItDoesTheWorkItself) {
  OptimizationSchedule schedule(nullptr, 0);
  schedule.want();
  schedule.start(0, two_stops(), {});
  const auto finished = schedule.fetch(0);
  ASSERT_TRUE(finished);
  ASSERT_TRUE(finished->solution.summary.usable);
  EXPECT_NEAR(finished->solution.T_map_robot[1].x_m, 1.0, 1e-9);
}

TEST(OptimizationSchedule, AfterAStrainedResultMoreStopsAreFree) {
  PoseGraph graph;
  graph.add_pose({});
  for (std::uint32_t i = 1; i < 2000; ++i) {
    graph.add_pose({1.0 * i, 0.0, 0.0});
    graph.add_edge({i - 1, i, EdgeKind::kOdometry, {1.0, 0.0, 0.0}});
  }
  const PoseGraphEdge loop{1990, 1999, EdgeKind::kRevisit, {9.1, 0.0, 0.0}};
  FakeOptimizer optimizer;
  optimizer.strained = true;
  OptimizationSchedule schedule(&optimizer, 0);
  schedule.want();
  schedule.start(0, graph, {&loop, 1});
  const std::size_t first = optimizer.problems.back().stops.size();
  EXPECT_LT(first, 300U);
  optimizer.strained = false;
  schedule.fetch(0);
  schedule.start(1, graph, {});
  ASSERT_EQ(optimizer.problems.size(), 1U);  // no strain: nothing more is needed
  optimizer.strained = true;
  schedule.want();
  schedule.start(2, graph, {&loop, 1});
  schedule.fetch(2);
  schedule.start(3, graph, {});
  ASSERT_EQ(optimizer.problems.size(), 3U);
  EXPECT_GT(optimizer.problems.back().stops.size(), 2 * first);
  schedule.fetch(3);
  schedule.start(4, graph, {});
  EXPECT_TRUE(optimizer.problems.back().whole);
  optimizer.strained = false;
  schedule.fetch(4);
  // The next loop starts with few stops again.
  schedule.want();
  schedule.start(5, graph, {&loop, 1});
  EXPECT_EQ(optimizer.problems.back().stops.size(), first);
  schedule.fetch(5);
  schedule.want_whole();
  schedule.start(6, graph, {});
  EXPECT_TRUE(optimizer.problems.back().whole);
}

}  // namespace
}  // namespace topogeo::localization
