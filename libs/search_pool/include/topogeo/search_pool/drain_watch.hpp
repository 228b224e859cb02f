// Decides when a worker that was asked to stop may exit.
#pragma once

#include <cstddef>
#include <limits>

#include "topogeo/support/patience.hpp"

namespace topogeo::search_pool {

/// A worker finishes its tasks first, however long that takes on a slow machine. Has no clock: the
/// caller passes the time, in seconds from any start, many times a second.
class DrainWatch {
 public:
  /// Wait without work: a client may still send a task because of an older status.
  static constexpr double kQuiet_s = 0.03;
  /// Limit without progress on an idle machine, after which the worker exits with work undone: a
  /// client that does not take its answers, a search that hangs, a client that sends tasks without
  /// end.
  static constexpr double kStuck_s = 10.0;

  explicit DrainWatch(double now_s) : clock_(now_s), quiet_since_s_(now_s) {}

  /// `open`: tasks in hand and answers waiting to be sent. `busy`: the CPU is short, time counts
  /// less. False: the worker may exit.
  [[nodiscard]] bool goes_on(double now_s, std::size_t open, bool busy);

 private:
  support::PatienceClock clock_;
  double quiet_since_s_;   // by the caller's clock
  double got_on_s_ = 0.0;  // last progress, by the patience clock
  std::size_t fewest_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace topogeo::search_pool
