#include "topogeo/localization/mapping/optimization_schedule.hpp"

#include <utility>

namespace topogeo::localization {

namespace {

// So many small corrections can add up to one that is worth an optimisation.
constexpr std::uint32_t kLoopsBetweenOptimizations = 10;

}  // namespace

void OptimizationSchedule::count_loop() {
  ++loops_since_;
  if (loops_since_ >= kLoopsBetweenOptimizations) wanted_ = true;
}

void OptimizationSchedule::start(std::uint32_t step, const PoseGraph& graph,
                                 std::span<const PoseGraphEdge> loops) {
  if (!wanted_ || due_) return;
  GraphProblem problem{graph.poses(), graph.edges()};
  problem.edges.insert(problem.edges.end(), loops.begin(), loops.end());
  started_loops_ = loops.size();
  optimizer().start(std::move(problem));
  due_ = step + delay_;
  wanted_ = false;
  loops_since_ = 0;
}

std::optional<OptimizationSchedule::Finished> OptimizationSchedule::fetch(std::uint32_t step) {
  if (!due_ || *due_ > step) return std::nullopt;
  return fetch_now();
}

std::optional<OptimizationSchedule::Finished> OptimizationSchedule::fetch_now() {
  if (!due_) return std::nullopt;
  due_.reset();
  Finished finished{optimizer().fetch(), std::exchange(started_loops_, 0)};
  ++optimizations_;
  if (!finished.solution.summary.usable) ++failed_;
  return finished;
}

}  // namespace topogeo::localization
