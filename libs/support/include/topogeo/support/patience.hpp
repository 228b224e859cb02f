// How long a program waits for others, on a machine that may have no time for either.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "topogeo/support/cpu_shortage.hpp"

namespace topogeo::support {

/// The time of a wait that counts against a patience. A span between two calls counts for
/// kLongestSpan_s at most: on a busy machine this process did not run, and answers that came
/// meanwhile are unread. The caller passes the time, in seconds from any start.
class PatienceClock {
 public:
  static constexpr double kLongestSpan_s = 1.0;
  /// The rate of advance() while the CPU is short: six programs that want one CPU make an answer
  /// take six times as long.
  static constexpr double kBusyRate = 1.0 / 6.0;

  explicit PatienceClock(double now_s, double longest_span_s = kLongestSpan_s)
      : last_call_s_(now_s), longest_span_s_(longest_span_s) {}

  /// Several times within the longest span. `rate`: the share, 0 to 1, of the time since the last
  /// call that counts. Returns time_s().
  double advance(double now_s, double rate = 1.0);
  /// The time that has counted so far, from 0.
  [[nodiscard]] double time_s() const { return time_s_; }

 private:
  double last_call_s_;
  double longest_span_s_;
  double time_s_ = 0.0;
};

/// Which of many waits have lasted longer than one patience, by the moments in which they began.
class PatienceWindow {
 public:
  PatienceWindow(double patience_s, double now_s)
      : patience_s_(patience_s), clock_(now_s), calls_{{now_s, 0.0}} {}

  /// `rate`: see PatienceClock::advance. Waits that began before the moment that is returned are
  /// over; nothing while none can be.
  std::optional<double> over_before(double now_s, double rate = 1.0);

 private:
  struct Call {
    double now_s = 0.0;
    double time_s = 0.0;  // by the patience clock
  };
  double patience_s_;
  PatienceClock clock_;
  std::deque<Call> calls_;  // from the newest that is a patience ago on
};

/// Patience of a command. While the threads of this process wait for a CPU, time counts only for
/// the share of its working time in which they run, and for PatienceClock::kBusyRate at least.
class Patience {
 public:
  /// `patience_s`: on a machine that is free.
  Patience(double patience_s, double now_s, CpuMeter meter = CpuMeter());

  /// Several times a second.
  [[nodiscard]] bool is_over(double now_s);
  /// The wait that counts begins again: something has come.
  void begin_again(double now_s);
  /// The part of the wait that has counted so far.
  [[nodiscard]] double waited_s() const { return clock_.time_s(); }
  /// For the end of an error message: "; this machine is too busy: the wait of 5.0 s took 23.1 s,
  /// and this program waited for a CPU 81 % of its working time". Empty where the wait has taken
  /// less than twice its time.
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
