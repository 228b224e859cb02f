// Host time of the scans of a Hokuyo laser. The laser answers with its time when asked (TM); scans
// carry its time, too, but arrive after their last beam.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/devices/device_clock.hpp"

namespace topogeo::devices {

class ScipClock {
 public:
  /// An answer to TM1: the laser's clock, and when the question left and the answer came. The
  /// fastest of the answers since restart() counts.
  void answered(std::uint32_t time_ms, std::int64_t asked_ns, std::int64_t arrival_ns);

  /// Host time of the time stamp of a scan that arrived at `arrival_ns`. `least_delay_ns`: between
  /// its stamp and its last beam. Empty for a stamp that does not follow the last one within a
  /// minute: the laser repeats a scan, or a disturbed line has passed a wrong one.
  [[nodiscard]] std::optional<std::int64_t> stamp_ns(std::uint32_t time_ms, std::int64_t arrival_ns,
                                                     std::int64_t least_delay_ns);
  /// Time of the laser between the last two stamps; 0 before.
  [[nodiscard]] std::int64_t passed_ns() const { return passed_ns_; }
  /// The laser is started anew.
  void restart();

 private:
  DeviceClock clock_{0};
  std::optional<std::int64_t> offset_ns_;  // host - laser, by TM1
  std::uint32_t asked_ms_ = 0;             // laser's time of that answer
  std::int64_t round_trip_ns_ = 0;         // of that answer
  std::optional<std::uint32_t> last_ms_;
  std::optional<std::uint32_t> before_ms_;  // the last one before the restart
  std::int64_t device_ns_ = 0;              // without wrapping
  std::int64_t passed_ns_ = 0;
  std::int64_t started_ns_ = 0;  // device_ns_ of the first scan
  std::int64_t delay_ns_ = 0;    // between the stamp of a scan and its arrival, at least
};

}  // namespace topogeo::devices
