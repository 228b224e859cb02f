// Growth rate of a total that is sampled from time to time.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <utility>

namespace topogeo::messaging {

/// The caller passes the time, which never goes back.
class TotalRate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Rates are means over this window, as in InputMeter.
  static constexpr std::chrono::seconds kWindow{5};

  /// Adds the current total, which never shrinks. Returns its growth per second since the first
  /// sample of the window, or since the last one before a pause; 0 for the first sample.
  double add(Time now, std::uint64_t total);

 private:
  std::deque<std::pair<Time, std::uint64_t>> samples_;  // oldest first
};

}  // namespace topogeo::messaging
