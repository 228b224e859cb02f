// Sample information, and the events of writers and readers.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>

namespace topogeo::messaging {

/// Names an instance of a keyed topic, a writer or a reader; usable as a key of ordered containers.
struct Handle {
  std::array<std::uint8_t, 16> bytes{};
  friend auto operator<=>(const Handle&, const Handle&) = default;
};

enum class InstanceState : std::uint8_t {
  kAlive = 0,
  kDisposed = 1,   ///< the writer disposed the instance
  kNoWriters = 2,  ///< the instance's last writer left or died
};

struct SampleInfo {
  bool valid = false;  ///< false: no message, only a change of the instance's state
  InstanceState state = InstanceState::kAlive;
  Handle instance;            ///< same for all samples of one key
  Handle writer;              ///< all zero for a kNoWriters found by this library
  std::int64_t stamp_ns = 0;  ///< wall clock of the writer's host when it wrote
};

/// Thrown by a message handler that refuses a message and has reported it itself: the message does
/// not count for its instance, and there is no event.
struct Refused final : std::exception {};

enum class EventKind : std::uint8_t {
  kMatched,
  kUnmatched,        ///< a matched peer left or its process is gone
  kIncompatibleQos,  ///< a peer of the topic exists but cannot connect
  kDeadlineMissed,
  kSampleLost,      ///< samples that will never arrive
  kSampleRejected,  ///< the reader's history was full; a reliable writer sends again
  kInvalidSample,   ///< a message of another schema version, over a bound, or refused by a handler
};

/// Fixed short name, for example "incompatible_qos".
const char* to_string(EventKind kind);

struct Event {
  EventKind kind{};
  std::string topic;
  Handle peer;         ///< writer or reader on the other side, for events about one
  int count = 0;       ///< peers after kMatched..., total of the kind for the others
  std::string detail;  ///< for people; names the policy for kIncompatibleQos
};

using EventHandler = std::function<void(const Event&)>;

}  // namespace topogeo::messaging
