// When a command that lists what lives on a domain has heard of all.
#pragma once

#include <cstddef>

namespace topogeo::cli {

/// Services publish their status twice a second. Has no clock: the caller passes the wait so far in
/// seconds, as support::Patience counts it.
class CollectWindow {
 public:
  static constexpr double kCollect_s = 1.2;  ///< at least: two periods, discovery takes the rest
  /// It goes on until none has come for longer than a period: a busy machine discovers some later.
  static constexpr double kSettled_s = 0.8;

  /// It ends after `longest_s`, however many there are.
  explicit CollectWindow(double longest_s) : longest_s_(longest_s) {}

  /// `count`: how many have been heard.
  [[nodiscard]] bool goes_on(double waited_s, std::size_t count) {
    if (count != count_) changed_s_ = waited_s;
    count_ = count;
    if (waited_s >= longest_s_) return false;
    return waited_s < kCollect_s || waited_s - changed_s_ < kSettled_s || count == 0;
  }

 private:
  double longest_s_;
  double changed_s_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace topogeo::cli
