// A release of the base that its gateway has not confirmed yet. The gateway refuses one that comes
// after a newer stop (docs/devices.md, "Stop and release the base"). No clock, no transport.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/msg/sensor.h"

namespace topogeo::web {

class UnconfirmedRelease {
 public:
  enum class Outcome : std::uint8_t {
    kReleased,    ///< the base reports that it may move
    kRefused,     ///< it is held by a stop that the release did not name
    kUnconfirmed  ///< it has reported neither; the other outcomes may follow
  };
  /// The base reports a release at once. A busy machine delays the report.
  static constexpr std::int64_t kPatience_ns = 1'000'000'000;
  /// A status may be on its way that the base sent before the last stop.
  static constexpr std::int64_t kOnItsWay_ns = 300'000'000;

  /// A release was sent that names `stop_count`. `held`: the newest status of the base has a stop.
  void begin(std::uint64_t stop_count, bool held, std::int64_t now_ns);
  /// A stop was sent.
  void end() { since_ns_.reset(); }
  /// Takes each status of the base. Returns an outcome that is new.
  std::optional<Outcome> take(const msg::BaseStatus& status, std::int64_t now_ns);
  /// Returns an outcome that is due without a status.
  std::optional<Outcome> check(std::int64_t now_ns);

 private:
  std::optional<std::int64_t> since_ns_;  // empty: no release waits
  std::uint64_t stop_count_ = 0;
  bool held_ = false;           // the base has reported a stop
  bool stopped_again_ = false;  // its newest status has another stop than the release
  bool reported_ = false;       // kUnconfirmed
};

/// Whether the status does not show if a stop holds.
inline bool hides_stop(const msg::BaseStatus& status) {
  return status.state() == msg::kBaseOffline || status.state() == msg::kBaseStarting;
}

}  // namespace topogeo::web
