#include "topogeo/slam/graph_optimization.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

Eigen::Matrix3d diagonal_of(double sigma_m, double sigma_rad) {
  const Eigen::Vector3d sigma(sigma_m, sigma_m, sigma_rad);
  return sigma.cwiseAbs2().asDiagonal();
}

// Out and back along a line. Odometry is 2 % too long out and 2 % too short back, which loops
// between the two correct; an additional loop is wrong by metres.
GraphProblem line(bool with_wrong_loop) {
  GraphProblem problem;
  problem.whole = true;
  problem.stops = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  problem.held = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  problem.T_map_robot.push_back({});
  for (std::uint32_t i = 1; i <= 10; ++i) {
    const Pose2 step{i == 6 ? 0.0 : (i < 6 ? 1.02 : 0.98), 0.0, i == 6 ? 3.14159265 : 0.0};
    problem.T_map_robot.push_back(problem.T_map_robot.back() * step);
    problem.edges.push_back({i - 1, i, EdgeKind::kOdometry, step, diagonal_of(0.1, 0.02)});
  }
  for (std::uint32_t i = 1; i <= 4; ++i) {
    const Pose2 facing{0.0, 0.0, 3.14159265};
    problem.edges.push_back({i, 11 - i, EdgeKind::kRevisit, facing, diagonal_of(0.02, 0.005)});
  }
  if (with_wrong_loop) {
    problem.edges.push_back({0, 5, EdgeKind::kRevisit, {1.0, 2.0, 0.5}, diagonal_of(0.02, 0.005)});
  }
  return problem;
}

TEST(GraphOptimizationTest, BendsTheWayToItsLoops) {
  const GraphProblem problem = line(false);
  const GraphSolution solution = solve(problem);
  EXPECT_TRUE(solution.summary.usable);
  EXPECT_TRUE(solution.outvoted.empty());
  ASSERT_EQ(solution.T_map_robot.size(), 11U);
  EXPECT_TRUE(solution.whole);
  EXPECT_FALSE(solution.strained);
  for (std::size_t i = 1; i <= 4; ++i) {
    EXPECT_LT(test::distance_m(solution.T_map_robot[i], solution.T_map_robot[11 - i]), 0.02) << i;
    EXPECT_GT(test::distance_m(problem.T_map_robot[i], problem.T_map_robot[11 - i]), 0.0);
  }
}

TEST(GraphOptimizationTest, ALoopThatTheRestContradictsIsLeftOut) {
  const GraphSolution with = solve(line(true));
  const GraphSolution without = solve(line(false));
  ASSERT_EQ(with.outvoted.size(), 1U);
  EXPECT_EQ(with.outvoted[0].from, 0U);
  EXPECT_EQ(with.outvoted[0].to, 5U);
  GraphProblem elsewhere = line(true);
  for (std::uint32_t& stop : elsewhere.stops) stop += 100;
  EXPECT_EQ(solve(elsewhere).outvoted.at(0).to, 105U);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_LT(test::distance_m(with.T_map_robot[i], without.T_map_robot[i]), 0.01) << i;
  }
}

TEST(GraphOptimizationTest, AHeldStopKeepsItsPlaceAndFeelsTheStrain) {
  GraphProblem problem = line(false);
  problem.held[9] = 1;
  problem.stops = {20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30};
  const GraphSolution solution = solve(problem);
  EXPECT_EQ(solution.T_map_robot[9], problem.T_map_robot[9]);
  EXPECT_TRUE(solution.strained);
  EXPECT_EQ(solution.stops, problem.stops);
  // A problem at rest has no strain.
  problem.edges.resize(10);
  EXPECT_FALSE(solve(problem).strained);
}

TEST(GraphOptimizationTest, TheJobIsFetchedOnce) {
  InPlaceOptimizer optimizer;
  EXPECT_THROW(optimizer.fetch(), std::logic_error);
  optimizer.start(line(false));
  EXPECT_THROW(optimizer.start(line(false)), std::logic_error);
  EXPECT_EQ(optimizer.fetch().T_map_robot, solve(line(false)).T_map_robot);
  EXPECT_THROW(optimizer.fetch(), std::logic_error);
}

TEST(GraphOptimizationTest, MovesWhatCameMeanwhileWithTheLastOfTheProblem) {
  PoseGraph graph;
  for (int i = 0; i < 4; ++i) graph.add_pose({1.0 * i, 0.0, 0.0});
  const std::vector<Pose2> solved{{0, 0, 0}, {1, 0, 0.5}};
  const std::vector<std::uint32_t> first_two{0, 1};
  graph.move(first_two, solved);
  EXPECT_EQ(graph.poses()[1], solved[1]);
  const Pose2 expected = solved[1] * Pose2{2.0, 0.0, 0.0};
  EXPECT_LT(test::distance_m(graph.poses()[3], expected), 1e-12);
  EXPECT_LT(test::turn_rad(graph.poses()[3], expected), 1e-12);
  EXPECT_THROW(graph.move({}, {}), std::invalid_argument);
  EXPECT_THROW(graph.move(std::vector<std::uint32_t>{4}, {solved.data(), 1}),
               std::invalid_argument);
  EXPECT_THROW(graph.move(first_two, {solved.data(), 1}), std::invalid_argument);
  // A single free stop in the middle moves nothing else.
  const Pose2 last = graph.poses()[3];
  graph.move(std::vector<std::uint32_t>{1, 3}, std::vector<Pose2>{{5, 5, 0}, last});
  EXPECT_EQ(graph.poses()[1].x_m, 5.0);
  EXPECT_EQ(graph.poses()[0], solved[0]);
  EXPECT_EQ(graph.poses()[3], last);
}

}  // namespace
}  // namespace topogeo::localization
