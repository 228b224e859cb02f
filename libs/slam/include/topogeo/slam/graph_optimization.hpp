// Least squares over a pose graph, or a part of it, as a separate job that need not hold up the
// robot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

/// Input of a job: a copy, so that the graph can grow meanwhile.
struct GraphProblem {
  std::vector<std::uint32_t> stops;          ///< of the graph, ascending
  std::vector<geometry::Pose2> T_map_robot;  ///< of these stops
  std::vector<std::uint8_t> held;            ///< nonzero: this stop keeps its pose
  std::vector<PoseGraphEdge> edges;          ///< `from` and `to` are indices of `stops`
  bool whole = false;                        ///< all stops of the graph
};

struct GraphSolution {
  OptimizationSummary summary;       ///< of the last optimisation
  std::vector<std::uint32_t> stops;  ///< of the problem, with their poses
  std::vector<geometry::Pose2> T_map_robot;
  std::vector<PoseGraphEdge> outvoted;  ///< loops left out because the rest contradicts them
  bool whole = false;
  /// A stop next to a held one has moved noticeably, so more stops should have been free.
  bool strained = false;
};

/// Optimises, leaves out outvoted loops and optimises again without them. The same problem has the
/// same solution. If the result is unusable, the poses are returned unchanged.
GraphSolution solve(const GraphProblem& problem);

/// Runs the jobs, one at a time.
class GraphOptimizer {
 public:
  virtual ~GraphOptimizer() = default;

  /// Throws std::logic_error if the previous job was not fetched.
  virtual void start(GraphProblem problem) = 0;
  /// Waits for the result. Throws std::logic_error if nothing was started.
  virtual GraphSolution fetch() = 0;

 protected:
  GraphOptimizer() = default;
  GraphOptimizer(const GraphOptimizer&) = default;
  GraphOptimizer& operator=(const GraphOptimizer&) = default;
};

/// Does the job in the calling thread when its result is fetched.
class InPlaceOptimizer : public GraphOptimizer {
 public:
  void start(GraphProblem problem) override;
  GraphSolution fetch() override;

 private:
  std::optional<GraphProblem> problem_;
};

}  // namespace topogeo::localization
