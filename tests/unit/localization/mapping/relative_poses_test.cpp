// PoseGraph::relative_to: what one stop knows of all others.
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/localization/mapping/pose_graph.hpp"

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

Eigen::Matrix3d variances_of_edge(double x_m2, double y_m2, double theta_rad2) {
  return Eigen::Vector3d(x_m2, y_m2, theta_rad2).asDiagonal();
}

const Pose2 kFirstStep{1.0, 0.2, 0.7};
const Pose2 kSecondStep{1.5, -0.1, -0.4};

// 0 - 1 - 2
PoseGraph chain() {
  PoseGraph graph;
  graph.add_pose({});
  graph.add_pose(kFirstStep);
  graph.add_pose(kFirstStep * kSecondStep);
  graph.add_edge({0, 1, EdgeKind::kOdometry, kFirstStep, variances_of_edge(0.01, 0.02, 0.003)});
  graph.add_edge({1, 2, EdgeKind::kOdometry, kSecondStep, variances_of_edge(0.03, 0.01, 0.002)});
  return graph;
}

TEST(RelativePosesTest, AStopIsCertainOfItself) {
  const auto relative = chain().relative_to(1);
  EXPECT_LT(test::distance_m(relative[1].T_a_b, {}), 1e-12);
  EXPECT_TRUE(relative[1].covariance.isZero());
}

TEST(RelativePosesTest, AChainIsComposedByHand) {
  const auto relative = chain().relative_to(0);
  ASSERT_EQ(relative.size(), 3U);
  EXPECT_TRUE(relative[1].covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003), 1e-9));
  const Eigen::Matrix3d expected =
      geometry::compose_covariance(kFirstStep, variances_of_edge(0.01, 0.02, 0.003), kSecondStep,
                                   variances_of_edge(0.03, 0.01, 0.002));
  EXPECT_TRUE(relative[2].covariance.isApprox(expected, 1e-9)) << relative[2].covariance;
  const Pose2 T = kFirstStep * kSecondStep;
  EXPECT_LT(test::distance_m(relative[2].T_a_b, T), 1e-12);
  // And backwards, where every edge is passed against its direction.
  const auto back = chain().relative_to(2);
  EXPECT_TRUE(back[0].covariance.isApprox(geometry::inverse_covariance(T, expected), 1e-9));
  EXPECT_LT(test::distance_m(back[0].T_a_b, geometry::inverse(T)), 1e-12);
}

TEST(RelativePosesTest, TheShorterOfTwoPathsCounts) {
  PoseGraph graph = chain();
  const Pose2 T_0_2 = kFirstStep * kSecondStep;
  const Eigen::Matrix3d worse = variances_of_edge(0.5, 0.5, 0.1);
  graph.add_edge({0, 2, EdgeKind::kRevisit, T_0_2, worse});
  const Eigen::Matrix3d by_chain = chain().relative_to(0)[2].covariance;
  EXPECT_TRUE(graph.relative_to(0)[2].covariance.isApprox(by_chain, 1e-9));

  PoseGraph shortcut = chain();
  const Eigen::Matrix3d better = variances_of_edge(0.001, 0.002, 0.0005);
  shortcut.add_edge({0, 2, EdgeKind::kRevisit, T_0_2, better});
  const auto relative = shortcut.relative_to(0);
  EXPECT_TRUE(relative[2].covariance.isApprox(better, 1e-9));
  // Still the direct edge for the first step: the way round by stop 2 is longer.
  EXPECT_TRUE(relative[1].covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003), 1e-9));
}

TEST(RelativePosesTest, ParallelEdgesCountTogether) {
  // Odometry knows the way along a corridor, the match the way across.
  PoseGraph graph;
  graph.add_pose({});
  graph.add_pose({1, 0, 0});
  graph.add_edge({0, 1, EdgeKind::kOdometry, {1, 0, 0}, variances_of_edge(0.01, 0.5, 0.04)});
  graph.add_edge({0, 1, EdgeKind::kSequential, {1, 0, 0}, variances_of_edge(4.0, 0.001, 0.0001)});
  const Eigen::Matrix3d covariance = graph.relative_to(0)[1].covariance;
  EXPECT_NEAR(covariance(0, 0), 1.0 / (1.0 / 0.01 + 1.0 / 4.0), 1e-9);
  EXPECT_NEAR(covariance(1, 1), 1.0 / (1.0 / 0.5 + 1.0 / 0.001), 1e-9);
  EXPECT_NEAR(covariance(2, 2), 1.0 / (1.0 / 0.04 + 1.0 / 0.0001), 1e-9);
}

TEST(RelativePosesTest, PosesThatNothingConnectsAreAsGoodAsUnknown) {
  PoseGraph graph = chain();
  graph.add_pose({7, 7, 1});
  const auto relative = graph.relative_to(0);
  EXPECT_GE(relative[3].covariance.diagonal().minCoeff(), 1e6);
  EXPECT_LT(test::distance_m(relative[3].T_a_b, {7, 7, 1}), 1e-12);
  const auto from_there = graph.relative_to(3);
  for (int i = 0; i < 3; ++i) EXPECT_GE(from_there[i].covariance(0, 0), 1e6);
  EXPECT_TRUE(from_there[3].covariance.isZero());
}

TEST(RelativePoses, PredictionsUseCalibratedCovariances) {
  PoseGraph graph;
  graph.add_pose({});
  graph.add_pose(kFirstStep);
  graph.add_edge({0, 1, EdgeKind::kOdometry, kFirstStep, variances_of_edge(0.09, 0.09, 0.01),
                  variances_of_edge(0.01, 0.02, 0.003)});
  EXPECT_TRUE(graph.relative_to(0)[1].covariance.isApprox(variances_of_edge(0.09, 0.09, 0.01)));
  EXPECT_TRUE(
      graph.predict_from(0, {})[1].covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003)));
}

TEST(RelativePoses, AlongThePathIsWhatTheStepsComposeTo) {
  PoseGraph graph = chain();
  // What else is known of the two ends does not count.
  graph.add_edge(
      {0, 2, EdgeKind::kRevisit, kFirstStep * kSecondStep, variances_of_edge(1e-4, 1e-4, 1e-5)});
  for (const auto& [from, to] : {std::pair{0U, 2U}, std::pair{2U, 0U}, std::pair{1U, 2U}}) {
    const UncertainPose path = graph.along_path(from, to);
    const UncertainPose composed = chain().relative_to(from)[to];
    EXPECT_NEAR(path.T_a_b.x_m, composed.T_a_b.x_m, 1e-12);
    EXPECT_TRUE(path.covariance.isApprox(composed.covariance, 1e-9)) << from << " " << to;
  }
  // Also after the poses have moved, and for a stop that came later.
  const std::vector<geometry::Pose2> moved{{0, 0, 0}, {2, 1, 0.5}};
  graph.move(moved);
  const UncertainPose first = graph.along_path(0, 1);
  EXPECT_NEAR(first.T_a_b.x_m, 2.0, 1e-12);
  EXPECT_TRUE(first.covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003), 1e-9));
}

}  // namespace
}  // namespace topogeo::localization
