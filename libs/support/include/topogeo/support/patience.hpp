// Time limits for waiting on others, on a machine that may be too busy for either side.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "topogeo/support/cpu_shortage.hpp"

namespace topogeo::support {

/// The time of a wait that counts against a time limit. A span between two calls counts for at most
/// kLongestSpan_s, because on a busy machine this process did not run, and answers that arrived
/// meanwhile are unread. The caller passes the time, in seconds from any start.
class PatienceClock {
 public:
  static constexpr double kLongestSpan_s = 1.0;
  /// The rate of advance() during a CPU shortage: six programs that want one CPU make an answer
  /// take six times as long.
  static constexpr double kBusyRate = 1.0 / 6.0;

  explicit PatienceClock(double now_s, double longest_span_s = kLongestSpan_s)
      : last_call_s_(now_s), longest_span_s_(longest_span_s) {}

  /// Call several times within the longest span. `rate`: the share, 0 to 1, of the time since the
  /// last call that counts. Returns time_s().
  double advance(double now_s, double rate = 1.0);
  /// The time counted so far, from 0.
  [[nodiscard]] double time_s() const { return time_s_; }

 private:
  double last_call_s_;
  double longest_span_s_;
  double time_s_ = 0.0;
};

/// Tells which of many waits have exceeded one time limit, by the times at which they began.
class PatienceWindow {
 public:
  PatienceWindow(double patience_s, double now_s)
      : patience_s_(patience_s), clock_(now_s), calls_{{now_s, 0.0}} {}

  /// `rate`: see PatienceClock::advance. Waits that began before the returned time are over; empty
  /// if none can be.
  std::optional<double> over_before(double now_s, double rate = 1.0);

 private:
  struct Call {
    double now_s = 0.0;
    double time_s = 0.0;  // by the patience clock
  };
  double patience_s_;
  PatienceClock clock_;
  std::deque<Call> calls_;  // from the newest one that is a full patience ago
};

/// Patience of a command. While the threads of this process wait for a CPU, time counts only for
/// the share of its working time in which they run, and at least for PatienceClock::kBusyRate.
class Patience {
 public:
  /// `patience_s`: on an idle machine.
  Patience(double patience_s, double now_s, CpuMeter meter = CpuMeter());

  /// Call several times a second.
  [[nodiscard]] bool is_over(double now_s);
  /// Restarts the wait, because an answer has arrived.
  void begin_again(double now_s);
  /// The time of the wait counted so far.
  [[nodiscard]] double waited_s() const { return clock_.time_s(); }
  /// Suffix for an error message: "; this machine is too busy: the wait of 5.0 s took 23.1 s, and
  /// this program waited for a CPU 81 % of its working time". Empty if the wait took less than
  /// twice its counted time.
  [[nodiscard]] std::string reason() const;

 private:
  double patience_s_;
  double start_s_;
  double now_s_;
  double measured_s_;
  double rate_ = 1.0;
  PatienceClock clock_;
  CpuMeter meter_;
  CpuUse use_;  // since the wait began
};

}  // namespace topogeo::support
