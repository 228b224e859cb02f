#include "topogeo/devices/device_clock.hpp"

#include <algorithm>

namespace topogeo::devices {
namespace {

/// The first message may be a late one; after this time the least delay is known.
constexpr std::int64_t kSettled_ns = 2'000'000'000;

}  // namespace

std::int64_t DeviceClock::lateness_ns(std::int64_t device_ns, std::int64_t arrival_ns) const {
  if (!started_) return 0;
  const std::int64_t late_ns =
      arrival_ns - transmission_ns_ - device_ns - std::min(least_ns_, before_ns_);
  return last_device_ns_ - first_device_ns_ < kSettled_ns ? std::max<std::int64_t>(late_ns, 0)
                                                          : late_ns;
}

void DeviceClock::settle(std::int64_t device_ns, std::int64_t offset_ns) {
  if (device_ns - window_ns_ > tracking_.window_ns) {
    // Offsets from before a long pause do not fit the clocks now.
    before_ns_ = device_ns - window_ns_ > 2 * tracking_.window_ns ? offset_ns : least_ns_;
    least_ns_ = offset_ns;
    window_ns_ = device_ns;
  }
  least_ns_ = std::min(least_ns_, offset_ns);
  const std::int64_t most_ns =
      std::max<std::int64_t>(0, device_ns - last_device_ns_) / tracking_.slew_divisor;
  offset_ns_ += std::clamp(std::min(least_ns_, before_ns_) - offset_ns_, -most_ns, most_ns);
}

std::int64_t DeviceClock::map(std::int64_t device_ns, std::int64_t arrival_ns) {
  const std::int64_t offset_ns = arrival_ns - transmission_ns_ - device_ns;
  if (started_) {
    settle(device_ns, offset_ns);
  } else {
    started_ = true;
    first_device_ns_ = window_ns_ = device_ns;
    offset_ns_ = least_ns_ = before_ns_ = offset_ns;
  }
  last_device_ns_ = device_ns;
  const std::int64_t stamp_ns = std::min(device_ns + offset_ns_, arrival_ns);
  const bool first = last_stamp_ns_ == std::numeric_limits<std::int64_t>::min();
  last_stamp_ns_ = first ? stamp_ns : std::max(stamp_ns, last_stamp_ns_ + 1);
  return last_stamp_ns_;
}

}  // namespace topogeo::devices
