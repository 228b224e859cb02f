// Publishes in a service's status whether the service gets the CPU time that it needs.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "topogeo/support/cpu_shortage.hpp"

namespace topogeo::service {

/// The counters are "cpu_wait_ratio" (average number of threads waiting for a CPU; absent where the
/// kernel does not count them) and "timer_delay_s" (largest delay of a timer of the loop), both
/// over the last second, and "cpu_short" (1 during a support::CpuShortage, else 0). A shortage is
/// not counted as a fault, because the service does nothing wrong.
class CpuWatch {
 public:
  static constexpr const char* kWaitRatio = "cpu_wait_ratio";
  static constexpr const char* kTimerDelay = "timer_delay_s";
  static constexpr const char* kShort = "cpu_short";

  /// The largest delay of a timer since the last call, seconds.
  using TimerDelay = std::function<double()>;
  using SetCounter = std::function<void(const char* name, double value)>;

  /// `meter` measures this process; tests pass one for another process.
  CpuWatch(TimerDelay timer_delay, SetCounter set_counter,
           support::CpuMeter meter = support::CpuMeter());

  /// Call it several times a second in the thread of the loop; it measures once a second. `now_s`
  /// may count from any start.
  void tick(double now_s);

  [[nodiscard]] bool lasts() const { return shortage_.lasts(); }
  /// Judges the last second alone: gives the reason for a halt at this moment.
  [[nodiscard]] bool is_short_now() const { return shortage_.is_short_now(); }
  [[nodiscard]] double timer_delay_s() const { return shortage_.timer_delay_s(); }
  /// "the CPU is short: ..." during a shortage; else empty.
  [[nodiscard]] std::string text() const { return lasts() ? shortage_.text() : std::string(); }

 private:
  TimerDelay timer_delay_;
  SetCounter set_counter_;
  support::CpuMeter meter_;
  support::CpuShortage shortage_;
  double due_s_ = 0.0;
};

}  // namespace topogeo::service
