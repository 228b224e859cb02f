#include "replay_pace.hpp"

namespace topogeo::sensor_gateway {

ReplayPace::Due ReplayPace::next(std::int64_t stamp_ns) {
  Due due;
  if (rate_ && last_stamp_ns_) {
    const std::int64_t gap_ns = stamp_ns - *last_stamp_ns_;
    const double gap_s = static_cast<double>(gap_ns) / 1e9;
    if (gap_ns > kLongestGap_ns) {
      due.shortened_gap_s = gap_s;
      after_s_ += kShortened_s;
    } else {
      after_s_ += gap_s / *rate_;
    }
  }
  last_stamp_ns_ = stamp_ns;
  due.after_s = after_s_;
  return due;
}

}  // namespace topogeo::sensor_gateway
