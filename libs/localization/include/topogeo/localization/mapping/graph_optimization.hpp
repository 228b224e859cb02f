// Least squares over a pose graph, or a part of it, as a job apart, so that it need not hold up the
// robot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"

namespace topogeo::localization {

/// What a job needs; a copy, so that the graph can grow meanwhile.
struct GraphProblem {
  std::vector<std::uint32_t> stops;          ///< of the graph, ascending
  std::vector<geometry::Pose2> T_map_robot;  ///< of these
  std::vector<std::uint8_t> held;            ///< which of these keep their pose
  std::vector<PoseGraphEdge> edges;          ///< `from` and `to` are indices of `stops`
  bool whole = false;                        ///< all stops of the graph
};

struct GraphSolution {
  OptimizationSummary summary;       ///< of the last optimisation
  std::vector<std::uint32_t> stops;  ///< of the problem, with their poses
  std::vector<geometry::Pose2> T_map_robot;
  std::vector<PoseGraphEdge> outvoted;  ///< loops that the rest contradicts: left out
  bool whole = false;
  /// A stop next to one that was held has moved noticeably: more stops should have been free.
  bool strained = false;
};

/// Optimises, leaves out the loops that are outvoted by then and optimises again without them. The
/// same problem has the same solution. An unusable result gives the poses as they were.
GraphSolution solve(const GraphProblem& problem);

/// Where the jobs are done. One at a time.
class GraphOptimizer {
 public:
  virtual ~GraphOptimizer() = default;

  /// Throws std::logic_error when the job before was not fetched.
  virtual void start(GraphProblem problem) = 0;
  /// Waits for the result. Throws std::logic_error when nothing was started.
  virtual GraphSolution fetch() = 0;

 protected:
  GraphOptimizer() = default;
  GraphOptimizer(const GraphOptimizer&) = default;
  GraphOptimizer& operator=(const GraphOptimizer&) = default;
};

/// Does the job when its result is asked for, in the same thread.
class InPlaceOptimizer : public GraphOptimizer {
 public:
  void start(GraphProblem problem) override;
  GraphSolution fetch() override;

 private:
  std::optional<GraphProblem> problem_;
};

}  // namespace topogeo::localization
