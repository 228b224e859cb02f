// Time of the packets of a laser that reports no time: the angle that it has turned, or the number
// of its samples, is its clock, mapped to the host's.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/devices/device_clock.hpp"

namespace topogeo::devices {

class TurnClock {
 public:
  /// `transmission_ns`: time that a packet takes on the line.
  explicit TurnClock(std::int64_t transmission_ns);

  /// Host time at which the laser measured the last beam of a packet that arrived at `arrival_ns`
  /// and was read at `read_ns`. `passed_ns` have passed since the last packet, by its speed or
  /// samples; a turn takes `turn_ns`. After a gap in which whole turns may have been lost the
  /// packets of a tenth of a second give no time, because only later ones show how late they come.
  [[nodiscard]] std::optional<std::int64_t> at(std::int64_t passed_ns, std::int64_t turn_ns,
                                               std::int64_t arrival_ns, std::int64_t read_ns);
  /// The next packet follows no earlier one.
  void restart() { started_ = false; }

 private:
  DeviceClock clock_;
  bool started_ = false;
  bool settling_ = false;
  std::int64_t device_ns_ = 0;  // by angle or samples
  std::int64_t last_arrival_ns_ = 0;
  std::int64_t settled_ns_ = 0;   // end of the moment without times
  std::int64_t punctual_ns_ = 0;  // last arrival that fits the clock
};

}  // namespace topogeo::devices
