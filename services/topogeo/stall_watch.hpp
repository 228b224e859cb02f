// Notices that a run does not get on.
#pragma once

#include <string>

namespace topogeo::cli {

inline constexpr double kStallTold_s = 60.0;     ///< without progress: it is said who waits
inline constexpr double kStallFailed_s = 180.0;  ///< without progress: the run has failed

/// The caller passes the time, in seconds from any start.
class StallWatch {
 public:
  enum class Verdict { kMoving, kTell, kGiveUp };

  explicit StallWatch(double now_s) : last_change_s_(now_s) {}

  /// `mark` is anything that changes with progress. kTell once for each stall.
  Verdict look(const std::string& mark, double now_s) {
    if (mark != mark_) {
      mark_ = mark;
      last_change_s_ = now_s;
      told_ = false;
      return Verdict::kMoving;
    }
    if (now_s - last_change_s_ >= kStallFailed_s) return Verdict::kGiveUp;
    if (told_ || now_s - last_change_s_ < kStallTold_s) return Verdict::kMoving;
    told_ = true;
    return Verdict::kTell;
  }

 private:
  std::string mark_;
  double last_change_s_;
  bool told_ = false;
};

}  // namespace topogeo::cli
