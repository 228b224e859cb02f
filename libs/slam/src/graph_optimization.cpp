#include "topogeo/slam/graph_optimization.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "least_squares.hpp"
#include "loop/outvoted_loop.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// A stop that should move less than this sees the same places: such a strain can wait for the
// optimisation of all stops.
constexpr double kStrain_m = 0.1;
constexpr double kStrain_rad = 0.02;

bool moved_noticeably(const Pose2& before, const Pose2& after) {
  return (after.position_m() - before.position_m()).squaredNorm() > kStrain_m * kStrain_m ||
         std::fabs(geometry::wrap_angle(after.theta_rad - before.theta_rad)) > kStrain_rad;
}

}  // namespace

GraphSolution solve(const GraphProblem& problem) {
  GraphSolution solution;
  solution.stops = problem.stops;
  solution.T_map_robot = problem.T_map_robot;
  solution.whole = problem.whole;
  std::vector<Pose2>& poses = solution.T_map_robot;
  solution.summary = least_squares(poses, problem.held, problem.edges);
  if (!solution.summary.usable) return solution;
  std::vector<PoseGraphEdge> kept;
  for (const PoseGraphEdge& edge : problem.edges) {
    (is_outvoted(edge, poses) ? solution.outvoted : kept).push_back(edge);
  }
  if (!solution.outvoted.empty()) {
    solution.summary = least_squares(poses, problem.held, kept);
    for (PoseGraphEdge& edge : solution.outvoted) {
      edge.from = problem.stops[edge.from];
      edge.to = problem.stops[edge.to];
    }
  }
  // The first stop of the map stays where it is for ever: no strain on it.
  const auto held = [&](std::uint32_t i) { return problem.held[i] != 0 && problem.stops[i] != 0; };
  solution.strained = std::any_of(kept.begin(), kept.end(), [&](const PoseGraphEdge& edge) {
    if (held(edge.from) == held(edge.to)) return false;
    const std::uint32_t free = held(edge.from) ? edge.to : edge.from;
    return moved_noticeably(problem.T_map_robot[free], poses[free]);
  });
  return solution;
}

void InPlaceOptimizer::start(GraphProblem problem) {
  if (problem_) throw std::logic_error("optimizer: the previous job was not fetched");
  problem_ = std::move(problem);
}

GraphSolution InPlaceOptimizer::fetch() {
  if (!problem_) throw std::logic_error("optimizer: no job was started");
  return solve(*std::exchange(problem_, std::nullopt));
}

}  // namespace topogeo::localization
