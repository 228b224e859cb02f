#include "optimization_schedule.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::localization {

namespace {

// This many small corrections can add up to one that is worth an optimisation.
constexpr std::size_t kLoopsBetweenOptimizations = 10;

}  // namespace

void OptimizationSchedule::count_loop(const PoseGraphEdge& loop) {
  fresh_.push_back({loop.from, loop.to});
  if (fresh_.size() >= kLoopsBetweenOptimizations) wanted_ = true;
}

void OptimizationSchedule::start(std::uint32_t step, const PoseGraph& graph,
                                 std::span<const PoseGraphEdge> loops) {
  if (!wanted_ || due_) return;
  optimizer().start(whole_ ? whole_problem(graph, loops)
                           : window_problem(graph, loops, fresh_, least_stops_));
  started_ = std::exchange(fresh_, {});
  for (const PoseGraphEdge& loop : loops) started_.push_back({loop.from, loop.to});
  started_loops_ = loops.size();
  due_ = step + delay_;
  wanted_ = whole_ = false;
}

std::optional<FinishedOptimization> OptimizationSchedule::fetch(std::uint32_t step) {
  if (!due_ || *due_ > step) return std::nullopt;
  return fetch_now();
}

std::optional<FinishedOptimization> OptimizationSchedule::fetch_now() {
  if (!due_) return std::nullopt;
  due_.reset();
  FinishedOptimization finished{optimizer().fetch(), std::exchange(started_loops_, 0)};
  if (finished.solution.strained) {
    wanted_ = true;
    least_stops_ = kGrowth * std::max(kLeastStops, finished.solution.stops.size());
    fresh_.insert(fresh_.begin(), started_.begin(), started_.end());
  } else {
    least_stops_ = kLeastStops;
  }
  ++optimizations_;
  if (!finished.solution.summary.usable) ++failed_;
  return finished;
}

}  // namespace topogeo::localization
