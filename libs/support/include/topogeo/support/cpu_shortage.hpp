// Whether a process gets the CPU time that it needs to be in time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "topogeo/support/thread_times.hpp"

namespace topogeo::support {

/// The time of the threads of a process between two moments, summed up.
struct CpuUse {
  double span_s = 0.0;    ///< between the two
  double ran_s = 0.0;     ///< on a CPU
  double waited_s = 0.0;  ///< for a CPU

  /// Threads that waited for a CPU, on average over the time.
  [[nodiscard]] double wait_ratio() const { return span_s > 0.0 ? waited_s / span_s : 0.0; }
  /// Waiting, as a share of the time in which there was work to do.
  [[nodiscard]] double wait_share() const;
};

/// Measures a process from one call to the next.
class CpuMeter {
 public:
  explicit CpuMeter(std::filesystem::path process = "/proc/self") : process_(std::move(process)) {}

  /// Since the last call, the caller passes the time. Nothing at the first one and where the kernel
  /// does not count.
  std::optional<CpuUse> take(double now_s);

 private:
  std::filesystem::path process_;
  std::optional<double> last_s_;
  std::map<long, ThreadTime> last_;
};

/// Decides when a process is short of CPU time, from what a second or so of it was like.
///
/// Two things must come together. Its timers fire late: that is what others notice, but a long
/// handler does it, too. And its threads wait for a CPU at least as long as they run: that is what
/// only other programs or a quota do, but a search on all CPUs does it without harm. Neither a
/// single late second nor a single good one counts.
class CpuShortage {
 public:
  /// Twice the period of a navigator's commands: it has missed one by then.
  static constexpr double kLate_s = 0.1;
  /// Work takes twice as long as on a machine that is free.
  static constexpr double kWaitShare = 0.5;
  /// A shortage is over only well below both: it would come and go near a threshold.
  static constexpr double kInTime_s = 0.05;
  static constexpr double kSmallWaitShare = 0.35;
  /// So many spans in a row begin a shortage: a program that starts takes one or two.
  static constexpr int kBegins = 3;
  /// So many end it: longer than between two turns of a load that comes and goes.
  static constexpr int kEnds = 5;

  /// `timer_delay_s`: the largest of the span. True when the answer of lasts() has changed.
  bool add(const CpuUse& use, double timer_delay_s);

  [[nodiscard]] bool lasts() const { return lasts_; }
  /// The last span alone.
  [[nodiscard]] bool is_short_now() const {
    return timer_delay_s_ >= kLate_s && use_.wait_share() >= kWaitShare;
  }
  [[nodiscard]] double timer_delay_s() const { return timer_delay_s_; }
  /// "the CPU is short: timers fire up to 0.4 s late, 71 % of its working time it waits for a CPU",
  /// of the last span.
  [[nodiscard]] std::string text() const;

 private:
  bool lasts_ = false;
  int in_row_ = 0;  // spans that contradict lasts_
  CpuUse use_;
  double timer_delay_s_ = 0.0;
};

}  // namespace topogeo::support
