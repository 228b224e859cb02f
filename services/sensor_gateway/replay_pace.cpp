#include "replay_pace.hpp"

#include <stdexcept>

namespace topogeo::sensor_gateway {

Rate parse_rate(const std::string& text) {
  constexpr double kSlowest = 0.01;
  constexpr double kFastest = 1000.0;
  if (text == "lossless") return std::nullopt;
  if (text == "realtime") return 1.0;
  try {
    std::size_t used = 0;
    const double factor = std::stod(text, &used);
    if (used == text.size() && factor >= kSlowest && factor <= kFastest) return factor;
  } catch (const std::logic_error&) {  // told below
  }
  throw std::invalid_argument("rate '" + text +
                              "': expected realtime, lossless or a factor from 0.01 to 1000");
}

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
