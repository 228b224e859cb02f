// Numbers the stops of a base, so that no reset from before a stop releases it: a link that was cut
// delivers a reset seconds late.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/messaging/events.hpp"

namespace topogeo::sensor_gateway {

class StopCount {
 public:
  /// `first` > 0: differs between starts of the gateway.
  explicit StopCount(std::uint64_t first) : number_(first), before_halts_(first) {}

  /// The last stop.
  [[nodiscard]] std::uint64_t number() const { return number_; }

  /// A writer of commands has halted the base, which may have been halted before.
  void halt(const messaging::Handle& writer);
  /// Whether an emergency stop holds. Its beginning is a stop.
  void emergency_stop(bool holds);
  /// Whether a writer that has seen the number `seen` may release the base. It knows its own halts,
  /// because they arrive before its reset.
  [[nodiscard]] bool may_release(const messaging::Handle& writer, std::uint64_t seen) const;

 private:
  std::uint64_t number_;
  bool emergency_stop_ = false;
  std::optional<messaging::Handle> halted_by_;  // the writer of all stops after before_halts_
  std::uint64_t before_halts_;
};

}  // namespace topogeo::sensor_gateway
