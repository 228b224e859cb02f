#include "topogeo/devices/scip_clock.hpp"

#include <algorithm>

#include "topogeo/devices/scip_protocol.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kScipMs_ns = 1'000'000;
constexpr std::uint32_t kLongestScipGap_ms = 60'000;
/// Clocks drift by little in this time, and some scans in it arrive without delay.
constexpr std::int64_t kLearning_ns = 30'000'000'000;

std::uint32_t passed_ms(std::uint32_t from_ms, std::uint32_t to_ms) {
  return (kScipTimeWrap_ms + to_ms - from_ms) % kScipTimeWrap_ms;
}

}  // namespace

void ScipClock::restart() {
  clock_.restart();
  offset_ns_.reset();
  if (last_ms_) before_ms_ = last_ms_;
  last_ms_.reset();
  passed_ns_ = 0;
}

void ScipClock::answered(std::uint32_t time_ms, std::int64_t asked_ns, std::int64_t arrival_ns) {
  const std::int64_t round_trip_ns = arrival_ns - asked_ns;
  if (offset_ns_ && round_trip_ns >= round_trip_ns_) return;
  round_trip_ns_ = round_trip_ns;
  asked_ms_ = time_ms;
  offset_ns_ = asked_ns + round_trip_ns / 2 - kScipMs_ns * time_ms;
}

std::optional<std::int64_t> ScipClock::stamp_ns(std::uint32_t time_ms, std::int64_t arrival_ns,
                                                std::int64_t least_delay_ns) {
  const bool first = !last_ms_;
  if (first) {
    // The laser repeats an old scan, which is older than its answer or from before the restart.
    if (offset_ns_ && passed_ms(asked_ms_, time_ms) > kLongestScipGap_ms) return std::nullopt;
    if (time_ms == before_ms_) return std::nullopt;
    // Counts on from the answer to TM1, which may lie before a wrap.
    device_ns_ = kScipMs_ns * (offset_ns_ ? asked_ms_ + std::int64_t{passed_ms(asked_ms_, time_ms)}
                                          : std::int64_t{time_ms});
    started_ns_ = device_ns_;
    delay_ns_ = least_delay_ns;
  } else {
    const std::uint32_t step_ms = passed_ms(*last_ms_, time_ms);
    if (step_ms == 0 || step_ms > kLongestScipGap_ms) return std::nullopt;
    passed_ns_ = kScipMs_ns * step_ms;
    device_ns_ += passed_ns_;
  }
  last_ms_ = time_ms;
  const std::int64_t arrived_ns = clock_.map(device_ns_, arrival_ns);
  if (offset_ns_ && device_ns_ - started_ns_ < kLearning_ns) {
    const std::int64_t delay_ns = std::max(least_delay_ns, arrived_ns - device_ns_ - *offset_ns_);
    delay_ns_ = first ? delay_ns : std::min(delay_ns_, delay_ns);
  }
  return arrived_ns - delay_ns_;
}

}  // namespace topogeo::devices
