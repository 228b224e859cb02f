// How old motion commands are when they come, by their stamps. A gateway that was frozen, or a link
// that was cut, hands over what was commanded long before: the base must not drive by it.
//
// The clocks of senders may be those of other hosts, which nobody sets. Navigator and page stamp by
// the gateway's own clock as they follow it (service/stamp_clock.hpp), so that a command of a new
// sender is fresh if it is so by that clock. Of a sender with another clock nothing is known at
// first; once it has been heard for a while, its quickest message shows how the clocks differ, and
// later ones are as old as they come later than that one.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "topogeo/messaging/events.hpp"

namespace topogeo::sensor_gateway {

class CommandAges {
 public:
  /// What is older is to be refused.
  static constexpr std::int64_t kOldest_ns = 300'000'000;
  /// A sender that was heard for so long has sent something since the first message came.
  static constexpr std::int64_t kKnown_ns = kOldest_ns;
  /// A sender that was silent for longer is new again: its messages may have waited as long.
  static constexpr std::int64_t kPause_ns = 1'000'000'000;
  /// All that a sender sends is equally late for so long: its clock was set back.
  static constexpr std::int64_t kSetBack_ns = 2'000'000'000;
  /// More senders than any robot has; further ones take the place of those not heard for longest.
  static constexpr std::size_t kMostSenders = 32;

  /// The age of a command with this stamp that has come from `sender` now, nanoseconds >= 0;
  /// nothing while it is not known. `now_ns`: by the steady clock, never back. `own_ns`: the same
  /// moment by the clock that stamps the gateway's messages.
  std::optional<std::int64_t> age_ns(const messaging::Handle& sender, std::int64_t stamp_ns,
                                     std::int64_t now_ns, std::int64_t own_ns);

 private:
  struct Sender {
    std::int64_t first_ns = 0;   ///< since when it is heard
    std::int64_t last_ns = 0;    ///< when it was heard last
    std::int64_t window_ns = 0;  ///< since when `least_ns` counts
    // The quickest way from stamp to arrival in this window and in the one before.
    std::int64_t least_ns = 0;
    std::int64_t before_ns = 0;
    std::optional<std::int64_t> old_since_ns{};  ///< since when all is old
    std::int64_t old_least_ns = 0;               ///< the quickest since then
    std::int64_t old_most_ns = 0;                ///< the slowest since then
  };

  Sender& sender_of(const messaging::Handle& handle, std::int64_t offset_ns, std::int64_t now_ns);
  static void note(Sender& sender, std::int64_t offset_ns, std::int64_t now_ns);
  static bool set_back(Sender& sender, bool old, std::int64_t offset_ns, std::int64_t now_ns);

  std::map<messaging::Handle, Sender> senders_;
};

}  // namespace topogeo::sensor_gateway
