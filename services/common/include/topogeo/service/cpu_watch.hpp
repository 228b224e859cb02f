// Publishes in the status of a service whether it gets the CPU time that it needs.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "topogeo/support/cpu_shortage.hpp"

namespace topogeo::service {

/// The counters are "cpu_wait_ratio" (threads that waited for a CPU, on average; not where the
/// kernel does not count), "timer_delay_s" (the largest delay of a timer of the loop), both of the
/// last second, and "cpu_short" (1 while support::CpuShortage lasts, else 0). It is no fault: the
/// service does nothing wrong.
class CpuWatch {
 public:
  static constexpr const char* kWaitRatio = "cpu_wait_ratio";
  static constexpr const char* kTimerDelay = "timer_delay_s";
  static constexpr const char* kShort = "cpu_short";

  /// The largest delay of a timer since the last call, seconds.
  using TimerDelay = std::function<double()>;
  using SetCounter = std::function<void(const char* name, double value)>;

  /// `meter`: of this process; tests measure others.
  CpuWatch(TimerDelay timer_delay, SetCounter set_counter,
           support::CpuMeter meter = support::CpuMeter());

  /// Several times a second, in the thread of the loop; it measures once a second. The caller
  /// passes the time, in seconds from any start.
  void tick(double now_s);

  [[nodiscard]] bool lasts() const { return shortage_.lasts(); }
  /// The last second alone: for the reason of a halt at this moment.
  [[nodiscard]] bool is_short_now() const { return shortage_.is_short_now(); }
  [[nodiscard]] double timer_delay_s() const { return shortage_.timer_delay_s(); }
  /// While it lasts: "the CPU is short: ..."; else empty.
  [[nodiscard]] std::string text() const { return lasts() ? shortage_.text() : std::string(); }

 private:
  TimerDelay timer_delay_;
  SetCounter set_counter_;
  support::CpuMeter meter_;
  support::CpuShortage shortage_;
  double due_s_ = 0.0;
};

}  // namespace topogeo::service
