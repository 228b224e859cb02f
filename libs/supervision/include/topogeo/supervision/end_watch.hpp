// Distinguishes a process that is slow to end from one that hangs.
//
// The time that an end takes depends on the machine. A slow program makes progress; a hanging one
// does not, however fast the machine is.
#pragma once

#include <cstdint>
#include <string>

#include <sys/types.h>

namespace topogeo::supervision {

/// The work that a process has done so far.
struct Progress {
  double ran_s = 0.0;           ///< CPU time of its threads
  double waited_s = 0.0;        ///< time that they were ready to run but had no CPU
  std::uint64_t reports = 0;    ///< statuses received from it
  bool waits_for_disk = false;  ///< now: one of its threads is in uninterruptible sleep
};

/// Reads the progress of a process of this machine, without reports; all zero if it is gone.
Progress read_progress(pid_t pid);

/// The caller passes the time, in seconds from any start.
class EndWatch {
 public:
  enum class Verdict : std::uint8_t { kWaits, kReport, kHangs };

  /// Less work than this within kHangs_s comes from the threads of the middleware, which go on when
  /// all others hang: 0.02 s in 20 s, measured on an idle service. If other programs keep the CPUs
  /// busy, these threads wait for longer than that, and a hanging process counts as slow until the
  /// load drops.
  static constexpr double kLeastWork_s = 0.2;
  /// Longer than any service waits for a peer while it ends (10 s for results that a client has not
  /// taken).
  static constexpr double kHangs_s = 20.0;
  static constexpr double kReportEvery_s = 5.0;

  EndWatch(const Progress& progress, double now_s)
      : mark_(progress), reported_(progress), mark_s_(now_s), report_s_(now_s + kReportEvery_s) {}

  /// Returns kReport every kReportEvery_s, when text() has changed.
  Verdict check(const Progress& progress, double now_s);

  /// "it worked for 1.2 s and waited 3.1 s for a CPU in the last 5 s".
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  Progress mark_;      // at the last progress
  Progress reported_;  // at the last report
  double mark_s_;
  double report_s_;
  std::string text_;
};

}  // namespace topogeo::supervision
