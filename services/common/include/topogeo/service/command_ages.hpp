// Ages of motion commands on arrival, from their stamps. After a frozen gateway or bridge, or a cut
// link, commands from long before arrive: the base must not drive by them.
//
// Senders may have clocks of other hosts that are not synchronized. Navigator and page stamp by the
// gateway's own clock as they follow it (service/stamp_clock.hpp), so a command of a new sender is
// fresh if it is fresh by that clock. For a sender with another clock the age is unknown at first.
// Once the sender has been heard for a while, its fastest message gives the offset between the
// clocks, and later messages are as old as they are slower than that one. A sender that was fresh
// by the gateway's clock is judged by that clock as well, because a steady delay of the network
// would otherwise count as a difference of the clocks.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "topogeo/messaging/events.hpp"

namespace topogeo::service {

class CommandAges {
 public:
  /// Older commands must be refused.
  static constexpr std::int64_t kOldest_ns = 300'000'000;
  /// A sender heard for so long has sent a message since its first one arrived.
  static constexpr std::int64_t kKnown_ns = kOldest_ns;
  /// A sender that was silent for longer counts as new: its messages may have waited as long.
  static constexpr std::int64_t kPause_ns = 1'000'000'000;
  /// If all messages of a sender are equally late for so long, its clock was set back.
  static constexpr std::int64_t kSetBack_ns = 2'000'000'000;
  /// No message is under way for longer: a stamp that is older shows another clock.
  static constexpr std::int64_t kLongestDelay_ns = 10'000'000'000;
  /// More senders than any robot has; further ones replace those silent for longest.
  static constexpr std::size_t kMostSenders = 32;

  /// The age of a command with this stamp that has just arrived from `sender`, nanoseconds >= 0;
  /// nothing while it is unknown. `now_ns`: by the steady clock, never going back. `own_ns`: the
  /// same moment by the clock that stamps the gateway's messages.
  std::optional<std::int64_t> age_ns(const messaging::Handle& sender, std::int64_t stamp_ns,
                                     std::int64_t now_ns, std::int64_t own_ns);

 private:
  struct Sender {
    std::int64_t first_ns = 0;   ///< first heard
    std::int64_t last_ns = 0;    ///< last heard
    std::int64_t window_ns = 0;  ///< start of the window of `least_ns`
    // The shortest delay from stamp to arrival in this window and in the previous one.
    std::int64_t least_ns = 0;
    std::int64_t before_ns = 0;
    std::optional<std::int64_t> old_since_ns{};  ///< since when all messages are old
    std::int64_t old_least_ns = 0;               ///< shortest delay since then
    std::int64_t old_most_ns = 0;                ///< longest delay since then
    bool own_clock = false;                      ///< stamps by the gateway's clock
  };

  Sender& sender_of(const messaging::Handle& handle, std::int64_t offset_ns, std::int64_t now_ns);
  /// Forgets all but whose clock it uses.
  static void begin(Sender& sender, std::int64_t offset_ns, std::int64_t now_ns);
  static void note(Sender& sender, std::int64_t offset_ns, std::int64_t now_ns);
  static bool set_back(Sender& sender, bool old, std::int64_t offset_ns, std::int64_t now_ns);

  std::map<messaging::Handle, Sender> senders_;
};

}  // namespace topogeo::service
