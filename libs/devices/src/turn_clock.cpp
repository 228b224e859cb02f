#include "topogeo/devices/turn_clock.hpp"

namespace topogeo::devices {
namespace {

/// Packets that a host has not read for a while arrive at once, so later ones are on time.
constexpr std::int64_t kSettle_ns = 100'000'000;
/// A clock that lags by more than a busy line delays, and for longer, is wrong.
constexpr std::int64_t kLargestTurnLag_ns = 150'000'000;
constexpr std::int64_t kLongestTurnLag_ns = 1'000'000'000;
/// The reported speed is rounded, or that of the last turn: time by the angle is a clock that gains
/// and loses some percent.
constexpr DeviceClock::Tracking kTracking{.window_ns = 500'000'000, .slew_divisor = 10};

}  // namespace

TurnClock::TurnClock(std::int64_t transmission_ns) : clock_(transmission_ns, kTracking) {}

std::optional<std::int64_t> TurnClock::at(std::int64_t passed_ns, std::int64_t turn_ns,
                                          std::int64_t arrival_ns, std::int64_t read_ns) {
  const std::int64_t missing_ns = arrival_ns - last_arrival_ns_ - passed_ns;
  const bool doubt = missing_ns > turn_ns / 2;
  if (!started_ || doubt) {
    settling_ = true;
    settled_ns_ = read_ns + kSettle_ns;
  }
  started_ = true;
  device_ns_ += passed_ns;
  last_arrival_ns_ = arrival_ns;
  if (settling_ && read_ns < settled_ns_) return std::nullopt;
  if (settling_) clock_.restart();
  settling_ = false;
  const std::int64_t time_ns = clock_.map(device_ns_, arrival_ns);
  if (arrival_ns - time_ns <= kLargestTurnLag_ns) {
    punctual_ns_ = arrival_ns;
  } else if (arrival_ns - punctual_ns_ > kLongestTurnLag_ns) {
    restart();
    return std::nullopt;
  }
  return time_ns;
}

}  // namespace topogeo::devices
