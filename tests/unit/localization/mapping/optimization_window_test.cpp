#include "optimization_window.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

Eigen::Matrix3d variances_of(double sigma_m, double sigma_rad) {
  const Eigen::Vector3d sigma(sigma_m, sigma_m, sigma_rad);
  return sigma.cwiseAbs2().asDiagonal();
}

// Rounds through a square of about 50 m, a stop each metre, with noisy measured steps; from the
// second round on each stop is matched with that of the previous round. The poses are the true
// ones, so that a graph with all loops is nearly at rest.
struct Rounds {
  PoseGraph graph;
  std::vector<Pose2> truth;
  static constexpr std::uint32_t kRound = 50;
};

Rounds rounds_of(std::uint32_t stops) {
  Rounds world;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto noisy = [&](const Pose2& T, double sigma_m, double sigma_rad) {
    return T *
           Pose2{sigma_m * normal(random), sigma_m * normal(random), sigma_rad * normal(random)};
  };
  for (std::uint32_t i = 0; i < stops; ++i) {
    const Pose2 T =
        i == 0 ? Pose2{}
               : world.truth.back() * Pose2{1.0, 0.0, 2.0 * 3.14159265358979 / Rounds::kRound};
    world.truth.push_back(T);
    world.graph.add_pose(T);
    if (i == 0) continue;
    world.graph.add_edge({i - 1, i, EdgeKind::kSequential,
                          noisy(geometry::between(world.truth[i - 1], T), 0.01, 0.002),
                          variances_of(0.02, 0.004)});
    if (i < Rounds::kRound) continue;
    const std::uint32_t earlier = i - Rounds::kRound;
    world.graph.add_edge({earlier, i, EdgeKind::kRevisit,
                          noisy(geometry::between(world.truth[earlier], T), 0.01, 0.002),
                          variances_of(0.02, 0.004)});
  }
  return world;
}

void apply(PoseGraph& graph, const GraphSolution& solution) {
  ASSERT_TRUE(solution.summary.usable);
  graph.move(solution.stops, solution.T_map_robot);
}

double largest_distance_m(const PoseGraph& a, const PoseGraph& b) {
  double largest_m = 0.0;
  for (std::size_t i = 0; i < a.poses().size(); ++i) {
    largest_m = std::max(largest_m, test::distance_m(a.poses()[i], b.poses()[i]));
  }
  return largest_m;
}

TEST(OptimizationWindow, OfALocalLoopMovesStopsAsTheWholeGraphDoes) {
  PoseGraph graph = rounds_of(600).graph;
  apply(graph, solve(whole_problem(graph, {})));
  // A loop shows that the last stop was placed 15 cm to the side.
  const PoseGraphEdge loop{500, 599, EdgeKind::kRevisit,
                           geometry::between(graph.poses()[500], graph.poses()[599]),
                           variances_of(0.02, 0.004)};
  graph.move(std::vector<std::uint32_t>{599},
             std::vector<Pose2>{graph.poses()[599] * Pose2{0.15, 0.0, 0.0}});
  PoseGraph whole = graph;
  const GraphProblem problem = window_problem(graph, {&loop, 1}, {}, 100);
  EXPECT_FALSE(problem.whole);
  EXPECT_LT(problem.stops.size(), 300U);
  const GraphSolution solution = solve(problem);
  EXPECT_FALSE(solution.strained);
  apply(graph, solution);
  apply(whole, solve(whole_problem(whole, {&loop, 1})));
  EXPECT_GT(test::distance_m(graph.poses()[599], whole.poses()[500]), 0.0);
  EXPECT_LT(largest_distance_m(graph, whole), 0.005);
}

// One round of 300 stops with drift, closed at its end.
TEST(OptimizationWindow, HoldsTheRoundThatALoopCloses) {
  constexpr std::uint32_t kCorridor = 1700;
  constexpr std::uint32_t kStops = 2000;
  PoseGraph graph;
  graph.add_pose({});
  std::vector<Pose2> truth{{}};
  const double turn_rad = 2.0 * 3.14159265358979 / 300;
  for (std::uint32_t i = 1; i < kStops; ++i) {
    // A straight corridor, then the round at its end.
    const Pose2 step{1.0, 0.0, i < kCorridor ? 0.0 : turn_rad};
    truth.push_back(truth.back() * step);
    const Pose2 measured{1.001, 0.0, step.theta_rad + (i < kCorridor ? 0.0 : 1e-4)};
    graph.add_pose(graph.poses().back() * measured);
    graph.add_edge({i - 1, i, EdgeKind::kSequential, measured, variances_of(0.02, 0.004)});
  }
  const PoseGraphEdge loop{kCorridor, kStops - 1, EdgeKind::kRevisit,
                           geometry::between(truth[kCorridor], truth.back()),
                           variances_of(0.02, 0.004)};
  PoseGraph whole = graph;
  const GraphProblem problem = window_problem(graph, {&loop, 1}, {}, 100);
  EXPECT_FALSE(problem.whole);
  EXPECT_LT(problem.stops.size(), 550U);
  for (std::uint32_t stop = kCorridor; stop < kStops; ++stop) {
    const auto found = std::lower_bound(problem.stops.begin(), problem.stops.end(), stop);
    ASSERT_TRUE(found != problem.stops.end() && *found == stop);
    EXPECT_EQ(problem.held[static_cast<std::size_t>(found - problem.stops.begin())], 0) << stop;
  }
  apply(graph, solve(problem));
  apply(whole, solve(whole_problem(whole, {&loop, 1})));
  // Compares the shape of the round: as a whole it is attached to the corridor, whose steps are
  // free to turn.
  for (std::uint32_t stop = kCorridor; stop < kStops; ++stop) {
    const auto in_round = [&](const PoseGraph& g) {
      return geometry::between(g.poses()[kCorridor], g.poses()[stop]);
    };
    EXPECT_LT(test::distance_m(in_round(graph), in_round(whole)), 0.02) << stop;
    EXPECT_LT(test::distance_m(in_round(graph), geometry::between(truth[kCorridor], truth[stop])),
              0.5);
  }
}

TEST(OptimizationWindow, OfMostStopsIsTheWholeGraph) {
  const PoseGraph graph = rounds_of(120).graph;
  EXPECT_TRUE(window_problem(graph, {}, {}, 120).whole);
  EXPECT_TRUE(window_problem(graph, {}, {}, 70).whole);
  const GraphProblem part = window_problem(graph, {}, {}, 20);
  EXPECT_FALSE(part.whole);
  // Each edge has at least one free end, and each edge of a free stop appears once.
  std::size_t expected = 0;
  const auto is_free = [&](std::uint32_t stop) {
    const auto found = std::lower_bound(part.stops.begin(), part.stops.end(), stop);
    return found != part.stops.end() && *found == stop &&
           part.held[static_cast<std::size_t>(found - part.stops.begin())] == 0;
  };
  for (const PoseGraphEdge& edge : graph.edges()) {
    if (is_free(edge.from) || is_free(edge.to)) ++expected;
  }
  EXPECT_EQ(part.edges.size(), expected);
  for (const PoseGraphEdge& edge : part.edges) {
    EXPECT_TRUE(part.held[edge.from] == 0 || part.held[edge.to] == 0);
  }
}

TEST(OptimizationWindow, IsTheSameOnEveryRun) {
  const Rounds world = rounds_of(400);
  const std::vector<LoopEnds> fresh{{10, 160}, {340, 399}};
  const GraphSolution a = solve(window_problem(world.graph, {}, fresh, 50));
  const GraphSolution b = solve(window_problem(PoseGraph(world.graph), {}, fresh, 50));
  EXPECT_EQ(a.stops, b.stops);
  EXPECT_EQ(a.T_map_robot, b.T_map_robot);
}

}  // namespace
}  // namespace topogeo::localization
