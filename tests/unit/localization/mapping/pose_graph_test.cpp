#include "topogeo/slam/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

Eigen::Matrix3d diagonal(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

TEST(PoseGraphTest, RefusesEdgesThatLeadNowhere) {
  PoseGraph graph;
  graph.add_pose({});
  graph.add_pose({1, 0, 0});
  const PoseGraphEdge good{0, 1, EdgeKind::kOdometry, {1, 0, 0}, diagonal(0.1, 0.1)};
  PoseGraphEdge wrong = good;
  wrong.to = 2;
  EXPECT_THROW(graph.add_edge(wrong), std::invalid_argument);
  wrong = good;
  wrong.from = 1;
  EXPECT_THROW(graph.add_edge(wrong), std::invalid_argument);
  wrong.to = 0;
  EXPECT_THROW(graph.add_edge(wrong), std::invalid_argument);
  EXPECT_TRUE(graph.edges().empty());
  EXPECT_NO_THROW(graph.add_edge(good));
}

TEST(PoseGraphTest, DisagreementIsTheSquaredMahalanobisDistance) {
  PoseGraph graph;
  graph.add_pose({0, 0, 90 * kDegree});
  graph.add_pose({0, 2, 90 * kDegree});  // 2 m ahead of the first
  const PoseGraphEdge edge{0, 1, EdgeKind::kRevisit, {1.7, 0, -0.2}, diagonal(0.1, 0.1)};
  EXPECT_NEAR(graph.disagreement(edge), 9.0 + 4.0, 1e-9);
}

// Rounds of 100 stops, more than are factorized, each shifted by the accumulated odometry error.
TEST(PoseGraphTest, AStepOfOdometryIsCorrectedAndNothingElse) {
  PoseGraph graph;
  for (int i = 0; i < 3; ++i) graph.add_pose({1.0 * i, 0, 0});
  for (std::uint32_t i = 0; i < 2; ++i) {
    graph.add_edge({i, i + 1, EdgeKind::kOdometry, {1, 0, 0}, diagonal(0.1, 0.1)});
    graph.add_edge({i, i + 1, EdgeKind::kSequential, {1.1, 0, 0}, diagonal(0.1, 0.1)});
  }
  graph.correct_step(1, {1.2, 0.1, 0});
  ASSERT_EQ(graph.edges().size(), 4U);
  EXPECT_EQ(graph.edges()[0].T_from_to, (Pose2{1.2, 0.1, 0}));
  EXPECT_EQ(graph.edges()[1].T_from_to, (Pose2{1.1, 0, 0}));
  EXPECT_EQ(graph.edges()[2].T_from_to, (Pose2{1, 0, 0}));
  EXPECT_EQ(graph.edges()[0].covariance, diagonal(0.1, 0.1));
  ASSERT_TRUE(graph.optimize().usable);
  // Between the two, which have equal weight except for the loss of the match.
  EXPECT_NEAR(graph.poses()[1].x_m, 1.15, 0.003);
  EXPECT_NEAR(graph.poses()[2].x_m, 1.15 + 1.05, 0.006);
}

TEST(PoseGraphTest, ManyStopsAreSpreadWithoutAFactorization) {
  constexpr std::uint32_t kRound = 100;
  constexpr std::uint32_t kStops = 6100;
  support::Random random(7);
  std::vector<Pose2> truth;
  for (std::uint32_t i = 0; i < kStops; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i % kRound) / kRound;
    truth.push_back({10.0 * std::cos(angle), 10.0 * std::sin(angle), geometry::wrap_angle(angle)});
  }
  PoseGraph graph;
  double cost_of_truth = 0.0;  // no optimum is worse
  for (std::uint32_t i = 0; i < kStops; ++i) {
    const std::uint32_t lap = i / kRound;
    graph.add_pose({truth[i].x_m + 0.002 * lap * (i > 0), truth[i].y_m, truth[i].theta_rad});
    if (i == 0) continue;
    Pose2 step = geometry::between(truth[i - 1], truth[i]);
    const double off_m = 0.01 * (random.uniform() - 0.5);
    step.x_m += off_m;
    cost_of_truth += 0.5 * (off_m / 0.05) * (off_m / 0.05);
    graph.add_edge({i - 1, i, EdgeKind::kOdometry, step, diagonal(0.05, 0.01)});
    if (i < kRound) continue;
    graph.add_edge({i - kRound, i, EdgeKind::kRevisit, {}, diagonal(0.02, 0.005)});
  }
  const OptimizationSummary summary = graph.optimize();
  EXPECT_TRUE(summary.usable);
  EXPECT_LT(summary.final_cost, cost_of_truth);
  EXPECT_LT(cost_of_truth, 0.5 * summary.initial_cost);
  double farthest_m = 0.0;
  for (std::uint32_t i = 0; i < kStops; ++i) {
    const Pose2& place = graph.poses()[i % kRound];
    farthest_m = std::max(farthest_m, (graph.poses()[i].position_m() - place.position_m()).norm());
  }
  EXPECT_LT(farthest_m, 0.03);  // 0.12 m before
}

TEST(PoseGraphTest, PlacesTheLastPoseBetweenWhatItsEdgesSay) {
  PoseGraph graph;
  graph.add_pose({});
  graph.add_pose({1, 0, 0});
  graph.add_edge({0, 1, EdgeKind::kOdometry, {1, 0, 0}, diagonal(0.1, 0.1)});
  graph.add_pose({5, 5, 1});
  graph.add_edge({1, 2, EdgeKind::kOdometry, {1.0, 0, 0}, diagonal(0.1, 0.1)});
  graph.add_edge({0, 2, EdgeKind::kSequential, {2.1, 0, 0}, diagonal(0.1, 0.1)});
  graph.place_last_pose();
  EXPECT_NEAR(graph.poses()[2].x_m, 2.05, 1e-3);
  EXPECT_NEAR(graph.poses()[2].y_m, 0.0, 1e-3);
  EXPECT_NEAR(graph.poses()[2].theta_rad, 0.0, 1e-3);
  EXPECT_EQ(graph.poses()[1], (Pose2{1, 0, 0}));
}

TEST(PoseGraphTest, NothingToOptimizeIsNoError) {
  PoseGraph graph;
  graph.add_pose({1, 2, 3});
  EXPECT_TRUE(graph.optimize().converged);
  EXPECT_EQ(graph.poses()[0], (Pose2{1, 2, 3}));
}

// Four sides of 4 m with left turns; odometry turns 2 degrees too far at each corner, so the square
// stays open by half a metre until the robot recognizes its start.
TEST(PoseGraphTest, ASquareClosesWithItsClosingEdge) {
  PoseGraph graph;
  const Pose2 odometry{4.0, 0.0, 92 * kDegree};
  graph.add_pose({});
  for (std::uint32_t i = 0; i < 4; ++i) {
    graph.add_pose(graph.poses().back() * odometry);
    graph.add_edge({i, i + 1, EdgeKind::kOdometry, odometry, diagonal(0.2, 0.1)});
  }
  EXPECT_GT(test::distance_m(graph.poses()[4], {}), 0.3);
  graph.add_edge({0, 4, EdgeKind::kRevisit, {0, 0, 0}, diagonal(0.01, 0.005)});
  const OptimizationSummary summary = graph.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  EXPECT_LT(test::distance_m(graph.poses()[4], {}), 0.01);
  EXPECT_LT(test::turn_rad(graph.poses()[4], {}), 0.3 * kDegree);
  // The error is spread over all corners of the square.
  const std::vector<Pose2> square{
      {0, 0, 0}, {4, 0, 90 * kDegree}, {4, 4, 180 * kDegree}, {0, 4, -90 * kDegree}};
  EXPECT_EQ(graph.poses()[0], square[0]);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_LT(test::distance_m(graph.poses()[i], square[i]), 0.15) << i;
    EXPECT_LT(test::turn_rad(graph.poses()[i], square[i]), 1.5 * kDegree) << i;
  }
}

// Pose i in a vector of all poses but the first.
Pose2 pose_in(const Eigen::VectorXd& x, std::uint32_t i) {
  const Eigen::Index row = 3 * (Eigen::Index{i} - 1);
  return {x(row), x(row + 1), x(row + 2)};
}

// Dense Gauss-Newton with numeric derivatives, without a loss function.
class DenseOracle {
 public:
  explicit DenseOracle(const PoseGraph& graph) : graph_(graph) {}

  Eigen::VectorXd residuals(const Eigen::VectorXd& x) const {
    const auto pose = [&](std::uint32_t i) {
      if (i == 0) return graph_.poses()[0];
      return pose_in(x, i);
    };
    Eigen::VectorXd out(3 * static_cast<Eigen::Index>(graph_.edges().size()));
    Eigen::Index row = 0;
    for (const PoseGraphEdge& edge : graph_.edges()) {
      const Pose2 now = geometry::between(pose(edge.from), pose(edge.to));
      const Eigen::Vector3d error(now.x_m - edge.T_from_to.x_m, now.y_m - edge.T_from_to.y_m,
                                  geometry::wrap_angle(now.theta_rad - edge.T_from_to.theta_rad));
      const Eigen::Matrix3d root = edge.covariance.inverse().llt().matrixU();
      out.segment<3>(row) = root * error;
      row += 3;
    }
    return out;
  }

  Eigen::VectorXd solve() const {
    Eigen::VectorXd x(3 * static_cast<Eigen::Index>(graph_.poses().size() - 1));
    for (std::size_t i = 1; i < graph_.poses().size(); ++i) {
      const Pose2& p = graph_.poses()[i];
      x.segment<3>(3 * static_cast<Eigen::Index>(i - 1)) << p.x_m, p.y_m, p.theta_rad;
    }
    for (int iteration = 0; iteration < 30; ++iteration) {
      const Eigen::VectorXd r = residuals(x);
      Eigen::MatrixXd jacobian(r.size(), x.size());
      for (Eigen::Index k = 0; k < x.size(); ++k) {
        Eigen::VectorXd up = x;
        Eigen::VectorXd down = x;
        up(k) += 1e-6;
        down(k) -= 1e-6;
        jacobian.col(k) = (residuals(up) - residuals(down)) / 2e-6;
      }
      x -= (jacobian.transpose() * jacobian).ldlt().solve(jacobian.transpose() * r);
    }
    return x;
  }

 private:
  PoseGraph graph_;  // before optimization
};

TEST(PoseGraphTest, FindsTheSameOptimumAsADenseSolver) {
  support::Random random(4);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<Pose2> truth{{}};
    PoseGraph graph;
    graph.add_pose({});
    const auto noisy = [&](const Pose2& T) {
      return Pose2{T.x_m + 0.05 * random.normal(), T.y_m + 0.05 * random.normal(),
                   geometry::wrap_angle(T.theta_rad + 0.03 * random.normal())};
    };
    // Any valid covariance, including correlated ones.
    const auto covariance = [&] {
      Eigen::Matrix3d root = diagonal(0.2, 0.17);
      root(1, 0) = random.uniform(-0.02, 0.02);
      root(2, 1) = random.uniform(-0.02, 0.02);
      return Eigen::Matrix3d(root * root.transpose());
    };
    constexpr std::uint32_t kPoses = 8;
    for (std::uint32_t i = 1; i < kPoses; ++i) {
      const Pose2 step{1.0, 0.0, random.uniform(-1.0, 1.0)};
      truth.push_back(truth.back() * step);
      const Pose2 measured = noisy(step);
      graph.add_pose(graph.poses().back() * measured);
      graph.add_edge({i - 1, i, EdgeKind::kOdometry, measured, covariance()});
    }
    for (int k = 0; k < 4; ++k) {
      const auto from = static_cast<std::uint32_t>(random.below(kPoses - 2));
      const auto to = from + 2 + static_cast<std::uint32_t>(random.below(kPoses - from - 2));
      // Odometry edges have no loss function, so the problem is plain least squares.
      graph.add_edge({from, to, EdgeKind::kOdometry,
                      noisy(geometry::between(truth[from], truth[to])), covariance()});
    }
    const DenseOracle oracle(graph);
    const Eigen::VectorXd expected = oracle.solve();
    const OptimizationSummary summary = graph.optimize();
    EXPECT_TRUE(summary.converged);
    EXPECT_NEAR(summary.final_cost, 0.5 * oracle.residuals(expected).squaredNorm(),
                1e-4 * summary.final_cost);
    for (std::uint32_t i = 1; i < kPoses; ++i) {
      const Pose2 optimum = pose_in(expected, i);
      EXPECT_LT(test::distance_m(graph.poses()[i], optimum), 2e-3) << trial << ", " << i;
      EXPECT_LT(test::turn_rad(graph.poses()[i], optimum), 1e-3) << trial << ", " << i;
    }
  }
}

// Out and back along a line; every stop on the way back sees its partner on the way out.
PoseGraph line_there_and_back() {
  PoseGraph graph;
  graph.add_pose({});
  for (std::uint32_t i = 1; i <= 20; ++i) {
    const Pose2 step{1.0, 0.0, i == 11 ? std::numbers::pi : 0.0};
    graph.add_pose(graph.poses().back() * step);
    graph.add_edge({i - 1, i, EdgeKind::kOdometry, step, diagonal(0.1, 0.05)});
  }
  for (std::uint32_t i = 0; i < 9; ++i) {
    graph.add_edge({i, 20 - i, EdgeKind::kRevisit,
                    geometry::between(graph.poses()[i], graph.poses()[20 - i]),
                    diagonal(0.03, 0.01)});
  }
  return graph;
}

double largest_shift_m(const PoseGraph& graph, const PoseGraph& truth) {
  double shift_m = 0.0;
  for (std::size_t i = 0; i < truth.poses().size(); ++i) {
    shift_m = std::max(shift_m, test::distance_m(graph.poses()[i], truth.poses()[i]));
  }
  return shift_m;
}

TEST(PoseGraphTest, OneWrongLoopAmongManyBendsTheMapALittle) {
  const PoseGraph truth = line_there_and_back();
  PoseGraph graph = truth;
  PoseGraphEdge wrong = truth.edges().back();
  wrong.from = 2;
  wrong.to = 18;
  wrong.T_from_to.x_m += 3.0;
  wrong.T_from_to.y_m += 1.5;
  graph.add_edge(wrong);
  graph.optimize();
  EXPECT_LT(largest_shift_m(graph, truth), 0.06);
  // Without the loss function, as an odometry edge, the same edge is harmful.
  PoseGraph plain = truth;
  wrong.kind = EdgeKind::kOdometry;
  plain.add_edge(wrong);
  plain.optimize();
  EXPECT_GT(largest_shift_m(plain, truth), 0.3);
}

TEST(PoseGraphTest, RemovesEdgesAndWhatTheyAddedToTheirLinks) {
  const PoseGraph truth = line_there_and_back();
  PoseGraph graph = truth;
  const auto as_before = graph.relative_to(0)[20].covariance;
  PoseGraphEdge extra = truth.edges().back();
  extra.kind = EdgeKind::kSequential;
  graph.add_edge(extra);
  const std::vector<PoseGraphEdge> one{extra};
  const auto of_pair = [&] { return graph.relative_to(extra.from)[extra.to].covariance(1, 1); };
  const double with = of_pair();
  graph.remove_edges(one);
  EXPECT_GT(of_pair(), 1.5 * with);
  EXPECT_EQ(graph.edges().size(), truth.edges().size());
  EXPECT_TRUE(graph.relative_to(0)[20].covariance.isApprox(as_before));
  graph.remove_edges(one);
  EXPECT_EQ(graph.edges().size(), truth.edges().size());
  // Without any loop, only odometry constrains the last stop.
  std::vector<PoseGraphEdge> loops;
  for (const PoseGraphEdge& edge : truth.edges()) {
    if (edge.kind == EdgeKind::kRevisit) loops.push_back(edge);
  }
  EXPECT_EQ(loops.size(), 9U);
  graph.remove_edges(loops);
  EXPECT_GT(graph.relative_to(0)[20].covariance(1, 1), 50.0 * as_before(1, 1));
  for (std::uint32_t stop = 0; stop < graph.poses().size(); ++stop) {
    for (const std::uint32_t i : graph.edges_at(stop)) {
      EXPECT_TRUE(graph.edges()[i].from == stop || graph.edges()[i].to == stop);
    }
  }
}

}  // namespace
}  // namespace topogeo::localization
