// When a worker that was asked to end may leave.
#pragma once

#include <cstddef>
#include <limits>

#include "topogeo/support/patience.hpp"

namespace topogeo::search_pool {

/// A worker finishes its tasks first, however long that takes on a slow machine. Has no clock: the
/// caller passes the time, in seconds from any start, many times a second.
class DrainWatch {
 public:
  /// It stays for so long without work: a client whose last status of it is older may send a task.
  static constexpr double kQuiet_s = 0.03;
  /// It leaves its work undone where that has not become less for so long on a machine that is
  /// free: a client that does not take its answers, a search that hangs, somebody who sends tasks
  /// without end.
  static constexpr double kStuck_s = 10.0;

  explicit DrainWatch(double now_s) : clock_(now_s), quiet_since_s_(now_s) {}

  /// `open`: tasks in hand and answers that wait to be sent. `busy`: the CPU is short, time counts
  /// less. False: it leaves.
  [[nodiscard]] bool goes_on(double now_s, std::size_t open, bool busy);

 private:
  support::PatienceClock clock_;
  double quiet_since_s_;   // by the caller's clock
  double got_on_s_ = 0.0;  // by the patience clock
  std::size_t fewest_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace topogeo::search_pool
