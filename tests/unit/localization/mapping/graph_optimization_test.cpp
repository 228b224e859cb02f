#include "topogeo/localization/mapping/graph_optimization.hpp"

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

// Out and back along a line. Odometry stretches every step by 2 %, so that the way back ends 20 cm
// beside the start only because of the loop; a second loop is wrong by metres.
GraphProblem line(bool with_wrong_loop) {
  GraphProblem problem;
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
  ASSERT_EQ(solution.covariance.size(), 11U);
  for (std::size_t i = 1; i <= 4; ++i) {
    EXPECT_LT(test::distance_m(solution.T_map_robot[i], solution.T_map_robot[11 - i]), 0.02) << i;
    EXPECT_GT(test::distance_m(problem.T_map_robot[i], problem.T_map_robot[11 - i]), 0.0);
  }
  EXPECT_TRUE(solution.covariance[0].isZero());
  EXPECT_GT(solution.covariance[5](0, 0), solution.covariance[1](0, 0));
}

TEST(GraphOptimizationTest, ALoopThatTheRestContradictsIsLeftOut) {
  const GraphSolution with = solve(line(true));
  const GraphSolution without = solve(line(false));
  ASSERT_EQ(with.outvoted.size(), 1U);
  EXPECT_EQ(with.outvoted[0].from, 0U);
  EXPECT_EQ(with.outvoted[0].to, 5U);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_LT(test::distance_m(with.T_map_robot[i], without.T_map_robot[i]), 0.01) << i;
  }
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
  graph.move(solved);
  EXPECT_EQ(graph.poses()[1], solved[1]);
  const Pose2 expected = solved[1] * Pose2{2.0, 0.0, 0.0};
  EXPECT_LT(test::distance_m(graph.poses()[3], expected), 1e-12);
  EXPECT_LT(test::turn_rad(graph.poses()[3], expected), 1e-12);
  EXPECT_THROW(graph.move({}), std::invalid_argument);
  EXPECT_THROW(graph.move(std::vector<Pose2>(5)), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
