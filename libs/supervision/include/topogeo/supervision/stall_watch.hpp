// Detects a run that makes no progress.
#pragma once

#include <cstdint>
#include <string>

namespace topogeo::supervision {

/// Long compared with any step of the services, short compared with a user's patience.
inline constexpr double kStallReported_s = 60.0;  ///< without progress: report who waits
inline constexpr double kStallFailed_s = 180.0;   ///< without progress: the run has failed

/// The caller passes the time, in seconds from any start.
class StallWatch {
 public:
  enum class Verdict : std::uint8_t { kMoving, kReport, kGiveUp };

  explicit StallWatch(double now_s) : last_change_s_(now_s) {}

  /// `mark` is any text that changes with progress. Returns kReport once for each stall.
  Verdict check(const std::string& mark, double now_s) {
    if (mark != mark_) {
      mark_ = mark;
      last_change_s_ = now_s;
      reported_ = false;
      return Verdict::kMoving;
    }
    if (now_s - last_change_s_ >= kStallFailed_s) return Verdict::kGiveUp;
    if (reported_ || now_s - last_change_s_ < kStallReported_s) return Verdict::kMoving;
    reported_ = true;
    return Verdict::kReport;
  }

 private:
  std::string mark_;
  double last_change_s_;
  bool reported_ = false;
};

}  // namespace topogeo::supervision
