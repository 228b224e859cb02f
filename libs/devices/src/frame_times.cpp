#include "topogeo/devices/frame_times.hpp"

#include <algorithm>

namespace topogeo::devices {
namespace {

/// A rhythm of 1.1 periods follows a device that is slower than stated. Where it is too slow, it
/// meets the arrivals, which are never early.
constexpr std::int64_t kRhythmTenths = 11;
/// Frames of one reading follow each other at least so soon.
constexpr std::int64_t kLeastShare = 4;
/// Frames were lost if the next one is later than 2.5 periods.
constexpr std::int64_t kLostHalves = 5;

}  // namespace

std::int64_t FrameTimes::next(std::size_t behind, std::int64_t now_ns) {
  const std::int64_t arrival_ns = now_ns - static_cast<std::int64_t>(behind) * period_ns_;
  std::int64_t time_ns = arrival_ns;
  if (last_ns_) {
    if (arrival_ns - *last_ns_ <= kLostHalves * period_ns_ / 2) {
      time_ns = std::min(arrival_ns, *last_ns_ + kRhythmTenths * period_ns_ / 10);
    }
    time_ns = std::max(time_ns, *last_ns_ + period_ns_ / kLeastShare);
  }
  last_ns_ = time_ns;
  return time_ns;
}

}  // namespace topogeo::devices
