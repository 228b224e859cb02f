// Limits the rate of an action: a bucket of tokens that fills at a rate.
#pragma once

#include <algorithm>

namespace topogeo::web {

class RateLimit {
 public:
  /// Allows `burst` actions at once, and `rate_per_s` in the long run. The caller passes the time,
  /// in seconds from any start, never going back.
  RateLimit(double rate_per_s, double burst)
      : rate_per_s_(rate_per_s), burst_(burst), left_(burst) {}

  /// False when the limit is exceeded.
  bool take(double now_s) {
    if (last_s_ > 0.0) left_ = std::min(burst_, left_ + (now_s - last_s_) * rate_per_s_);
    last_s_ = now_s;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double rate_per_s_;
  double burst_;
  double left_;
  double last_s_ = 0.0;
};

}  // namespace topogeo::web
