// When the pose graph is optimised: wanted, started, and taken over a fixed number of steps later.
//
// A result takes effect at its step, whenever it was ready: a log gives the same poses however long
// the optimisation took.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "topogeo/localization/mapping/graph_optimization.hpp"
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
  /// A loop was closed that alone needs none; after some of them one is wanted all the same.
  void count_loop();

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
  [[nodiscard]] GraphOptimizer& optimizer() { return optimizer_ ? *optimizer_ : in_place_; }

  GraphOptimizer* optimizer_;
  InPlaceOptimizer in_place_;
  std::uint32_t delay_;
  bool wanted_ = false;
  std::uint32_t loops_since_ = 0;     // the last start
  std::optional<std::uint32_t> due_;  // step at which the running one takes effect
  std::size_t started_loops_ = 0;     // waiting ones in it
  std::uint64_t optimizations_ = 0;
  std::uint64_t failed_ = 0;  // of those, without a usable result
};

}  // namespace topogeo::localization
