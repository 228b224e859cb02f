// How fast a total grows that is sampled from time to time.
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

  /// Rates are means over this time, as those of InputMeter.
  static constexpr std::chrono::seconds kWindow{5};

  /// The total as it is now, which does not shrink. Returns its growth per second since the first
  /// of the samples of the window, or since the last one before a pause; 0 for the first sample.
  double add(Time now, std::uint64_t total);

 private:
  std::deque<std::pair<Time, std::uint64_t>> samples_;  // oldest first
};

}  // namespace topogeo::messaging
