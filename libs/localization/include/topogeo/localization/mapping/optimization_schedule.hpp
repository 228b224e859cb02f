// When the pose graph is optimised: wanted, started, and taken over a fixed number of steps later.
//
// A result takes effect at its step, whenever it was ready: a log gives the same poses however long
// the optimisation took. It covers the stops that the new loops can move, more of them after a
// result that was strained.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/localization/mapping/graph_optimization.hpp"
#include "topogeo/localization/mapping/optimization_window.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"

namespace topogeo::localization {

class OptimizationSchedule {
 public:
  /// The optimizer must outlive the schedule; without one the work is done when its result is
  /// fetched. `delay`: steps from the start of an optimisation to its effect.
  OptimizationSchedule(GraphOptimizer* optimizer, std::uint32_t delay)
      : optimizer_(optimizer), delay_(delay) {}

  /// An optimisation is wanted at the next opportunity.
  void want() { wanted_ = true; }
  /// One of all stops is.
  void want_whole() { wanted_ = whole_ = true; }
  /// A loop became part of the graph that alone needs none; after some of them one is wanted all
  /// the same.
  void count_loop(const PoseGraphEdge& loop);

  /// Starts one of the graph and the loops that wait to become part of it, if one is wanted and
  /// none is running.
  void start(std::uint32_t step, const PoseGraph& graph, std::span<const PoseGraphEdge> loops);

  struct Finished {
    GraphSolution solution;
    std::size_t loops = 0;  ///< how many of the waiting loops it took in: the first ones
  };
  /// The running one, when it is due at this step or before.
  std::optional<Finished> fetch(std::uint32_t step);
  /// The running one, due or not.
  std::optional<Finished> fetch_now();

  [[nodiscard]] std::uint64_t optimizations() const { return optimizations_; }
  [[nodiscard]] std::uint64_t failed() const { return failed_; }

 private:
  /// Optimised in a few milliseconds, some 30 m of path where each place was driven thrice.
  static constexpr std::size_t kLeastStops = 150;
  static constexpr std::size_t kGrowth = 4;  // of the next window, after a strained one

  [[nodiscard]] GraphOptimizer& optimizer() { return optimizer_ ? *optimizer_ : in_place_; }

  GraphOptimizer* optimizer_;
  InPlaceOptimizer in_place_;
  std::uint32_t delay_;
  bool wanted_ = false;
  bool whole_ = false;
  std::size_t least_stops_ = kLeastStops;
  std::vector<LoopEnds> fresh_;       // counted since the last start
  std::vector<LoopEnds> started_;     // those of the running one, the waiting loops among them
  std::optional<std::uint32_t> due_;  // step at which the running one takes effect
  std::size_t started_loops_ = 0;     // waiting ones in it
  std::uint64_t optimizations_ = 0;
  std::uint64_t failed_ = 0;  // of those, without a usable result
};

}  // namespace topogeo::localization
