// Schedule of pose graph optimisations: requested, started, and applied a fixed number of steps
// later.
//
// A result takes effect at its step, whenever it was ready: a log gives the same poses however long
// the optimisation took. It covers the stops that the new loops can move, and more of them after a
// strained result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/slam/graph_optimization.hpp"
#include "topogeo/slam/pose_graph.hpp"

#include "optimization_window.hpp"

namespace topogeo::localization {

struct FinishedOptimization {
  GraphSolution solution;
  std::size_t loops = 0;  ///< number of waiting loops included: the first ones
};

class OptimizationSchedule {
 public:
  /// The optimizer must outlive the schedule. Without one the work is done when its result is
  /// fetched. `delay`: steps from the start of an optimisation to its effect.
  OptimizationSchedule(GraphOptimizer* optimizer, std::uint32_t delay)
      : optimizer_(optimizer), delay_(delay) {}

  /// Requests an optimisation at the next opportunity.
  void want() { wanted_ = true; }
  /// Requests an optimisation of all stops.
  void want_whole() { wanted_ = whole_ = true; }
  /// Counts a loop in the graph that needs no optimisation alone; after some of these one is
  /// requested.
  void count_loop(const PoseGraphEdge& loop);

  /// Starts an optimisation of the graph with the loops waiting to join it, if one is requested and
  /// none is running.
  void start(std::uint32_t step, const PoseGraph& graph, std::span<const PoseGraphEdge> loops);

  /// The running optimisation, if it is due at this step or before.
  std::optional<FinishedOptimization> fetch(std::uint32_t step);
  /// The running optimisation, due or not.
  std::optional<FinishedOptimization> fetch_now();

  [[nodiscard]] std::uint64_t optimizations() const { return optimizations_; }
  [[nodiscard]] std::uint64_t failed() const { return failed_; }

 private:
  /// Optimised in a few milliseconds: some 30 m of path where each place was passed three times.
  static constexpr std::size_t kLeastStops = 150;
  static constexpr std::size_t kGrowth = 4;  // of the next window after a strained one

  [[nodiscard]] GraphOptimizer& optimizer() { return optimizer_ ? *optimizer_ : in_place_; }

  GraphOptimizer* optimizer_;
  InPlaceOptimizer in_place_;
  std::uint32_t delay_;
  bool wanted_ = false;
  bool whole_ = false;
  std::size_t least_stops_ = kLeastStops;
  std::vector<LoopEnds> fresh_;       // counted since the last start
  std::vector<LoopEnds> started_;     // loops of the running one, including the waiting loops
  std::optional<std::uint32_t> due_;  // step at which the running one takes effect
  std::size_t started_loops_ = 0;     // waiting loops in the running one
  std::uint64_t optimizations_ = 0;
  std::uint64_t failed_ = 0;  // without a usable result
};

}  // namespace topogeo::localization
