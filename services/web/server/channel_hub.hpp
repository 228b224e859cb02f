// The state shown to viewers: channels, each a value or a table of objects, with versions that let
// a returning viewer get exactly the changes it lacks.
//
// Viewers pull: the hub keeps the newest state and no messages, so that a slow viewer costs
// nothing. A message joins all changes since the version that a viewer holds; viewers with the same
// version share one text.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/support/cpu_time.hpp"

namespace topogeo::web {

/// In the order in which changes are sent to a viewer.
enum class Channel : std::uint8_t {
  kTime,
  kPose,
  kDrive,
  kNavigator,
  kBase,
  kGoals,
  kMap,
  kTiles,
  kRooms,
  kPlaces,
  kRules,
  kDrawing,
  kScan,
  kRoute,
  kTruth,
  kLaser,
  kTrail,
  kGraph,
  kServices,
  kWorkers,
  kMerges,
  kLocalMap,
  kSearch,
  kLoops,
  kEvents,
  kAlarms,
  kViewers,
  kControls,
};
inline constexpr std::size_t kChannels = static_cast<std::size_t>(Channel::kControls) + 1;

/// Name in the protocol: "pose", "local_map", ...
std::string_view name_of(Channel channel);
std::optional<Channel> channel_of(std::string_view name);
/// False for a value.
bool is_table(Channel channel);

/// A new object of a table, as JSON; empty: removed.
struct Edit {
  std::string key;
  std::string json;
};

/// The message that brings a viewer up to date.
struct Update {
  std::shared_ptr<const std::string> text;  ///< a whole message
  std::uint64_t version = 0;                ///< version that the viewer then holds
};

/// Thread-safe.
class ChannelHub {
 public:
  /// Largest number of removed keys remembered per table; a viewer that has missed more gets the
  /// whole table.
  static constexpr std::size_t kRemembered = 4096;

  /// `clock_s`: seconds from any start, never going back; gives the ages of values.
  explicit ChannelHub(std::function<double()> clock_s = support::monotonic_s)
      : clock_s_(std::move(clock_s)) {}

  /// Calls `on_change` after each change, in the thread that made it, without holding a lock.
  void on_change(std::function<void(Channel)> handler);

  /// Replaces a value, as JSON. An equal value is no change, but counts as heard anew.
  void set(Channel channel, std::string json);
  /// The same with a value that is made when a viewer first asks for it: for what changes often and
  /// takes time to make. `make` owns its data, for it may be called from any thread, and must not
  /// call the hub. Each call is a change.
  void set_later(Channel channel, std::function<std::string()> make);
  /// Age of each value in seconds, as JSON: {"pose":0.1,...}.
  [[nodiscard]] std::string ages_s() const;
  /// Viewers get all edits of one call together. Equal objects are no change. `anew` removes all
  /// objects that are not among the edits.
  void edit(Channel channel, std::vector<Edit> edits, bool anew = false);

  /// 0 before the first change. Never waits for another thread.
  [[nodiscard]] std::uint64_t version(Channel channel) const;
  /// Update for a viewer with version `held` (0: none), which is not the current one. A larger
  /// version, which was never given out, counts as none.
  [[nodiscard]] Update update(Channel channel, std::uint64_t held) const;

 private:
  struct Object {
    std::string json;
    std::uint64_t version = 0;
  };
  struct State {
    std::uint64_t version = 0;
    mutable std::string value;
    mutable std::function<std::string()> make_value;  // empty: `value` is up to date
    double set_s = 0.0;
    std::map<std::string, Object> objects;
    std::deque<std::pair<std::uint64_t, std::string>> gone;  // version and key, ascending
    std::uint64_t forgotten = 0;  // removals up to this version are no longer known
    // The last messages made for the current version, by their starting version.
    mutable std::map<std::uint64_t, std::shared_ptr<const std::string>> texts;
  };

  [[nodiscard]] static std::string text(Channel channel, const State& state, std::uint64_t from);
  [[nodiscard]] State& state(Channel channel) {
    return states_.at(static_cast<std::size_t>(channel));
  }
  [[nodiscard]] const State& state(Channel channel) const {
    return states_.at(static_cast<std::size_t>(channel));
  }
  static bool apply(State& state, std::vector<Edit>& edits, bool anew);
  void report(Channel channel);
  void show_version(Channel channel);

  std::function<double()> clock_s_;
  mutable std::mutex mutex_;
  std::vector<State> states_ = std::vector<State>(kChannels);
  std::array<std::atomic<std::uint64_t>, kChannels> versions_{};  // as in states_
  std::function<void(Channel)> on_change_;
};

}  // namespace topogeo::web
