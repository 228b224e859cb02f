// The clock that stamps sensor messages, as seen from another process.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace topogeo::service {

/// Gateway and localizer stamp by the gateway's clock, which is the clock of its host as it was
/// when the gateway started. StampClock follows it: the fastest message of the last ten seconds
/// gives the offset between the two clocks, so that the age of a delayed message counts from its
/// measurement. Neither host's clock matters, nor whether it was set in the meantime.
class StampClock {
 public:
  static constexpr std::int64_t kHalfWindow_ns = 5'000'000'000;
  static constexpr std::int64_t kSetBack_ns = 1'000'000'000;

  /// `offset_ns`: from the steady clock to the stamps, until a message has come.
  explicit StampClock(std::int64_t offset_ns) : offset_ns_(offset_ns) {}

  /// Takes the stamp of a gateway message and the time at which it arrived by the steady clock.
  void observe(std::int64_t stamp_ns, std::int64_t steady_ns) {
    turn_over(steady_ns);
    const std::int64_t offset_ns = stamp_ns - steady_ns;
    newest_ns_ = std::max(newest_ns_, offset_ns);
    offset_ns_ = std::max(newest_ns_, older_ns_);
  }

  /// Goes back only when the stamps have gone back by more than a second; see take_set_back().
  std::int64_t now_ns(std::int64_t steady_ns) {
    std::int64_t now_ns = steady_ns + offset_ns_;
    if (now_ns < last_ns_) {
      if (last_ns_ - now_ns > kSetBack_ns) {
        set_back_ = true;
      } else {
        now_ns = last_ns_;
      }
    }
    last_ns_ = now_ns;
    return now_ns;
  }

  /// True once after the time has gone back: earlier measurements cannot be compared any more.
  bool take_set_back() {
    const bool set_back = set_back_;
    set_back_ = false;
    return set_back;
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();

  void turn_over(std::int64_t steady_ns) {
    if (window_ns_ == kNever) window_ns_ = steady_ns;
    if (steady_ns - window_ns_ < kHalfWindow_ns) return;
    older_ns_ = steady_ns - window_ns_ < 2 * kHalfWindow_ns ? newest_ns_ : kNever;
    newest_ns_ = kNever;
    window_ns_ = steady_ns;
  }

  std::int64_t offset_ns_;
  std::int64_t window_ns_ = kNever;  // when the newer half began
  std::int64_t newest_ns_ = kNever;  // largest offset since then
  std::int64_t older_ns_ = kNever;   // and in the half before
  std::int64_t last_ns_ = kNever;    // last result of now_ns()
  bool set_back_ = false;
};

}  // namespace topogeo::service
