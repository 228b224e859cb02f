#include "topogeo/localization/mapping/graph_optimization.hpp"

#include <stdexcept>
#include <utility>

namespace topogeo::localization {
namespace {

// Squared Mahalanobis distance of a loop after optimisation: a right loop comes this far once in a
// million (chi-square, three degrees of freedom).
constexpr double kOutvoted = 30.0;

}  // namespace

GraphSolution solve(const GraphProblem& problem) {
  PoseGraph graph;
  for (const geometry::Pose2& pose : problem.T_map_robot) graph.add_pose(pose);
  for (const PoseGraphEdge& edge : problem.edges) graph.add_edge(edge);
  GraphSolution solution;
  solution.summary = graph.optimize();
  if (solution.summary.usable) {
    solution.outvoted = graph.remove_edges(EdgeKind::kRevisit, kOutvoted);
    if (!solution.outvoted.empty()) solution.summary = graph.optimize();
  }
  solution.T_map_robot = graph.poses();
  for (const UncertainPose& pose : graph.relative_to(0)) {
    solution.covariance.push_back(pose.covariance);
  }
  return solution;
}

void InPlaceOptimizer::start(GraphProblem problem) {
  if (problem_) throw std::logic_error("optimizer: the job before was not fetched");
  problem_ = std::move(problem);
}

GraphSolution InPlaceOptimizer::fetch() {
  if (!problem_) throw std::logic_error("optimizer: nothing was started");
  return solve(*std::exchange(problem_, std::nullopt));
}

}  // namespace topogeo::localization
