// Detects whether a process gets enough CPU time to be punctual.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "topogeo/support/thread_times.hpp"

namespace topogeo::support {

/// Total times of the threads of a process between two moments.
struct CpuUse {
  double span_s = 0.0;    ///< between the moments
  double ran_s = 0.0;     ///< on a CPU
  double waited_s = 0.0;  ///< for a CPU

  /// Average number of threads that waited for a CPU.
  [[nodiscard]] double wait_ratio() const { return span_s > 0.0 ? waited_s / span_s : 0.0; }
  /// Waiting, as a share of the time with work to do.
  [[nodiscard]] double wait_share() const;
};

/// Measures a process between successive calls.
class CpuMeter {
 public:
  explicit CpuMeter(std::filesystem::path process = "/proc/self") : process_(std::move(process)) {}

  /// Use since the last call; the caller passes the time. Empty at the first call and if the kernel
  /// does not count.
  std::optional<CpuUse> take(double now_s);

 private:
  std::filesystem::path process_;
  std::optional<double> last_s_;
  std::map<long, ThreadTime> last_;
};

/// Decides whether a process is short of CPU time, from measurements over a second or so.
///
/// Two conditions must hold. Timers of the process fire late: others notice that, but a long
/// handler causes it, too. And its threads wait for a CPU at least as long as they run: only other
/// programs or a quota cause that, but a search on all CPUs does so without harm. Neither a single
/// late second nor a single good one counts.
class CpuShortage {
 public:
  /// Twice the period of a navigator's commands: by then it has missed one.
  static constexpr double kLate_s = 0.1;
  /// Work takes twice as long as on an idle machine.
  static constexpr double kWaitShare = 0.5;
  /// A shortage ends only well below both: near a threshold it would begin and end repeatedly.
  static constexpr double kInTime_s = 0.05;
  static constexpr double kSmallWaitShare = 0.35;
  /// Successive bad spans that begin a shortage: a starting program takes one or two.
  static constexpr int kBegins = 3;
  /// Successive good spans that end it: longer than the pauses of an intermittent load.
  static constexpr int kEnds = 5;

  /// `timer_delay_s`: the largest one in the span. True if the result of lasts() has changed.
  bool add(const CpuUse& use, double timer_delay_s);

  [[nodiscard]] bool lasts() const { return lasts_; }
  /// Whether the last span alone was short.
  [[nodiscard]] bool is_short_now() const {
    return timer_delay_s_ >= kLate_s && use_.wait_share() >= kWaitShare;
  }
  [[nodiscard]] double timer_delay_s() const { return timer_delay_s_; }
  /// Describes the last span: "the CPU is short: timers fire up to 0.4 s late, 71 % of the working
  /// time is waiting for a CPU".
  [[nodiscard]] std::string text() const;

 private:
  bool lasts_ = false;
  int in_row_ = 0;  // spans that contradict lasts_
  CpuUse use_;
  double timer_delay_s_ = 0.0;
};

}  // namespace topogeo::support
