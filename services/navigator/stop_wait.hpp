// Whether a navigator that has just started must hold the robot, because it may have missed an
// operator's stop.
#pragma once

#include <cstdint>
#include <optional>

namespace topogeo::navigator {

/// A page passes its stop to a navigator as soon as the two are connected, which takes a moment.
/// A base that reports its state holds itself, so its first status ends the wait, and so does the
/// first order of an operator. Times are those of the steady clock.
class StopWait {
 public:
  /// Discovery takes less than a second; the rest is for a busy machine.
  static constexpr std::int64_t kLongest_ns = 3'000'000'000;

  explicit StopWait(std::int64_t start_ns) : until_ns_(start_ns + kLongest_ns) {}

  /// A stop of the base can be missed no longer. Returns whether the wait ends by that.
  bool end() {
    const bool ends = waits();
    until_ns_.reset();
    return ends;
  }
  /// Returns whether the wait ends now.
  bool check(std::int64_t now_ns) { return until_ns_ && now_ns >= *until_ns_ && end(); }
  [[nodiscard]] bool waits() const { return until_ns_.has_value(); }

 private:
  std::optional<std::int64_t> until_ns_;  // empty: over
};

}  // namespace topogeo::navigator
