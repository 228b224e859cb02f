// PoseGraph::relative_to: poses and covariances of all stops relative to one.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/slam/pose_graph.hpp"

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
  // Backwards, every edge is traversed against its direction.
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
  // The direct edge for the first step remains: the detour by stop 2 is longer.
  EXPECT_TRUE(relative[1].covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003), 1e-9));
}

TEST(RelativePosesTest, ParallelEdgesCountTogether) {
  // Odometry constrains the direction along a corridor, the match the direction across.
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
  EXPECT_TRUE(graph.predict_from(0, std::vector<std::uint32_t>{1})
                  .at(1)
                  .covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003)));
}

TEST(RelativePoses, PredictionsVisitTheNearestByCostAtMostSoMany) {
  PoseGraph graph;
  graph.add_pose({});
  for (std::uint32_t i = 1; i < 6; ++i) {
    graph.add_pose({1.0 * i, 0.0, 0.0});
    graph.add_edge(
        {i - 1, i, EdgeKind::kOdometry, {1.0, 0.0, 0.0}, variances_of_edge(0.01, 0.01, 0.001)});
  }
  graph.add_edge({0, 5, EdgeKind::kRevisit, {5.0, 0.0, 0.0}, variances_of_edge(1e-4, 1e-4, 1e-5)});
  const std::vector<std::uint32_t> wanted{1, 3, 5};
  const auto reached = [&](std::size_t most) {
    const RelativePoses found = graph.predict_from(0, wanted, PoseGraph::kUnlimited, most);
    std::vector<std::uint32_t> ids;
    for (const RelativePoses::Stop& stop : found.stops()) ids.push_back(stop.id);
    return ids;
  };
  // Itself first, then 5 by the loop, 1 and 4 by one step each, 2 and 3 by two.
  EXPECT_EQ(reached(1), std::vector<std::uint32_t>{});
  EXPECT_EQ(reached(2), std::vector<std::uint32_t>{5});
  EXPECT_EQ(reached(4), (std::vector<std::uint32_t>{1, 5}));
  EXPECT_EQ(reached(6), wanted);
}

TEST(RelativePoses, AlongThePathIsWhatTheStepsComposeTo) {
  PoseGraph graph = chain();
  // Other edges between the two ends do not count.
  graph.add_edge(
      {0, 2, EdgeKind::kRevisit, kFirstStep * kSecondStep, variances_of_edge(1e-4, 1e-4, 1e-5)});
  for (const auto& [from, to] : {std::pair{0U, 2U}, std::pair{2U, 0U}, std::pair{1U, 2U}}) {
    const UncertainPose path = graph.along_path(from, to);
    const UncertainPose composed = chain().relative_to(from)[to];
    EXPECT_NEAR(path.T_a_b.x_m, composed.T_a_b.x_m, 1e-12);
    EXPECT_TRUE(path.covariance.isApprox(composed.covariance, 1e-9)) << from << " " << to;
  }
  // This holds after the poses have moved, and for a later stop.
  const std::vector<geometry::Pose2> moved{{0, 0, 0}, {2, 1, 0.5}};
  graph.move(std::vector<std::uint32_t>{0, 1}, moved);
  const UncertainPose first = graph.along_path(0, 1);
  EXPECT_NEAR(first.T_a_b.x_m, 2.0, 1e-12);
  EXPECT_TRUE(first.covariance.isApprox(variances_of_edge(0.01, 0.02, 0.003), 1e-9));
}

// A path of 100 stops on a circle, the last of which match the first.
PoseGraph circle() {
  PoseGraph graph;
  const Pose2 step{0.5, 0.01, 0.0628};
  graph.add_pose({});
  for (std::uint32_t i = 1; i < 100; ++i) {
    graph.add_pose(graph.poses().back() * step);
    graph.add_edge(
        {i - 1, i, EdgeKind::kSequential, step, variances_of_edge(1e-4 * (1 + i % 3), 1e-4, 1e-5)});
  }
  for (std::uint32_t i = 0; i < 10; ++i) {
    const Pose2 T = geometry::between(graph.poses()[i], graph.poses()[90 + i]);
    graph.add_edge({i, 90 + i, EdgeKind::kRevisit, T, variances_of_edge(4e-4, 4e-4, 4e-5)});
  }
  return graph;
}

TEST(RelativePoses, ABoundedSearchFindsWhatTheUnboundedDoes) {
  const PoseGraph graph = circle();
  for (const std::uint32_t origin : {0U, 47U, 99U}) {
    const std::vector<UncertainPose> all = graph.relative_to(origin);
    std::vector<std::uint32_t> ids(100);
    std::iota(ids.begin(), ids.end(), 0U);
    const RelativePoses near = graph.relative_to(origin, ids, 0.01);
    EXPECT_GT(near.stops().size(), 3U);
    EXPECT_LT(near.stops().size(), all.size());
    std::uint32_t before = 0;
    for (const RelativePoses::Stop& stop : near.stops()) {
      EXPECT_TRUE(stop.id == 0 || stop.id > before);
      before = stop.id;
      EXPECT_TRUE(stop.T_origin_stop.covariance.isApprox(all[stop.id].covariance, 1e-12) ||
                  stop.id == origin);
      EXPECT_EQ(stop.T_origin_stop.T_a_b, all[stop.id].T_a_b);
    }
    const std::vector<std::uint32_t> wanted{3, 50, 95};
    const RelativePoses some = graph.relative_to(origin, wanted);
    ASSERT_EQ(some.stops().size(), 3U);
    for (const std::uint32_t id : wanted) {
      EXPECT_TRUE(some.at(id).covariance.isApprox(all[id].covariance, 1e-12));
      EXPECT_EQ(some.at(id).T_a_b, all[id].T_a_b);
    }
    EXPECT_THROW(static_cast<void>(some.at(51)), std::out_of_range);
  }
}

TEST(RelativePoses, StopsNearAPlaceAreThoseOfASearchOverAll) {
  const PoseGraph graph = circle();
  const Eigen::Vector2d place_m(3.0, 4.0);
  std::vector<std::pair<double, std::uint32_t>> by_distance;
  for (std::uint32_t i = 0; i < 90; ++i) {
    by_distance.emplace_back((graph.poses()[i].position_m() - place_m).norm(), i);
  }
  std::sort(by_distance.begin(), by_distance.end());
  for (const std::size_t most : {std::size_t{5}, std::size_t{200}}) {
    const double radius_m = by_distance[20].first + 1e-9;
    const std::vector<std::uint32_t> near = graph.stops_near(place_m, radius_m, most, 90);
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < std::min<std::size_t>(most, 21); ++i) {
      expected.push_back(by_distance[i].second);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(near, expected);
  }
}

TEST(RelativePoses, StopsAreVisitedByThePathFromTheNearestOrigin) {
  const PoseGraph graph = circle();
  const std::vector<std::uint32_t> origins{20, 60};
  std::vector<std::uint32_t> visited;
  double last = 0.0;
  graph.visit_nearest(origins, [&](std::uint32_t stop, double cost) {
    EXPECT_GE(cost, last);
    last = cost;
    visited.push_back(stop);
    return visited.size() < 10;
  });
  std::sort(visited.begin(), visited.end());
  EXPECT_EQ(visited, (std::vector<std::uint32_t>{18, 19, 20, 21, 22, 58, 59, 60, 61, 62}));
}

TEST(RelativePoses, AlongThePathHoldsOverBlocksOfStopsAndAfterChanges) {
  PoseGraph graph = circle();
  const auto check = [&](std::uint32_t from, std::uint32_t to) {
    UncertainPose composed;
    for (std::uint32_t stop = from + 1; stop <= to; ++stop) {
      const Eigen::Matrix3d step = graph.links_to(stop).front().second;
      composed = compose(composed,
                         {geometry::between(graph.poses()[stop - 1], graph.poses()[stop]), step});
    }
    const UncertainPose path = graph.along_path(from, to);
    EXPECT_TRUE(path.covariance.isApprox(composed.covariance, 1e-9)) << from << " " << to;
  };
  for (const auto& [from, to] :
       {std::pair{0U, 31U}, std::pair{31U, 32U}, std::pair{5U, 89U}, std::pair{40U, 64U}}) {
    check(from, to);
    EXPECT_TRUE(graph.along_path(from, from).covariance.isZero(1e-12));
  }
  // A stop at the border of two blocks moves, and the covariance of a step shrinks.
  graph.move(std::vector<std::uint32_t>{31, 98}, std::vector<Pose2>{{3, 4, 1}, graph.poses()[98]});
  check(5, 89);
  check(30, 40);
  graph.add_edge(
      {63, 64, EdgeKind::kOdometry, {0.5, 0.01, 0.0628}, variances_of_edge(1e-5, 1e-5, 1e-6)});
  check(5, 89);
}

}  // namespace
}  // namespace topogeo::localization
