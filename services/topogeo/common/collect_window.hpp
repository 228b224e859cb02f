// Decides when a command that lists a domain has heard all of its services.
#pragma once

#include <cstddef>

namespace topogeo::cli {

/// Services publish their status twice a second. Has no clock: the caller passes the wait so far in
/// seconds, as support::Patience counts it.
class CollectWindow {
 public:
  static constexpr double kCollect_s = 1.2;  ///< shortest wait: two periods, plus discovery
  /// The wait continues until no service has come for more than a period, because a busy machine
  /// discovers some late.
  static constexpr double kSettled_s = 0.8;

  /// The wait ends after `longest_s`, regardless of the count.
  explicit CollectWindow(double longest_s) : longest_s_(longest_s) {}

  /// `count`: number of services heard so far.
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
