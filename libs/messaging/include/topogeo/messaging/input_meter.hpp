// Measures the rate of an input and the time since its last message.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <utility>

namespace topogeo::messaging {

/// The caller passes the time, which never goes back.
class InputMeter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Rates are means over this window: long enough for a robot that stops every second, short
  /// enough to show at once that an input has ceased.
  static constexpr std::chrono::seconds kWindow{5};

  void count(Time now);

  [[nodiscard]] std::uint64_t total() const { return total_; }
  /// Inputs per second over the window. While the first one is more recent than that, the time
  /// since it counts, but at least a second.
  [[nodiscard]] double rate_per_s(Time now) const;
  /// Seconds since the last one; 0 before the first.
  [[nodiscard]] double age_s(Time now) const;

 private:
  std::uint64_t total_ = 0;
  Time first_;
  Time last_;
  std::deque<std::pair<Time, std::uint64_t>> recent_;  // start of a time slice, count in it
};

}  // namespace topogeo::messaging
