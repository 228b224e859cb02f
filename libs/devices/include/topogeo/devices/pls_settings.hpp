// Everything about a SICK laser that is uncertain or a matter of taste, in one place. The values
// come from published drivers and from manufacturer's documents for the LMS; those marked so are
// not confirmed on hardware.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

enum class PlsOutput {
  kContinuous,  ///< the sensor sends scan after scan
  kOnRequest,   ///< every scan is asked for
};

struct PlsSettings {
  // The line.
  /// The rate to work at: 9600, 19200, 38400 or 500000; 500000 needs an RS-422 line.
  std::uint32_t baud = 500'000;
  /// The rate after power-on unless the owner made another one permanent (all drivers).
  std::uint32_t power_on_baud = 9600;
  /// Rates to search for the sensor at, in this order (BeeSoft's and CARMEN's, then the others).
  std::vector<std::uint32_t> detection_bauds{9600, 38400, 500'000, 19200};
  /// A PLS has even parity, an LMS none; with both, the kind of sensor is found out. All rates are
  /// tried with the first before the second.
  std::vector<Parity> parities{Parity::kEven, Parity::kNone};
  /// Eight characters; an owner may have changed them. The LMS gets its own.
  std::string password_pls = "SICK_PLS";
  std::string password_lms = "SICK_LMS";
  PlsOutput output = PlsOutput::kContinuous;

  // Times. Where several drivers differ, the value suits the slowest; not confirmed on hardware.
  /// From the end of a command to ACK or NAK (40 ms by a comment in BeeSoft).
  std::int64_t ack_timeout_ns = 80'000'000;
  /// From ACK to the reply to a change of mode (3 s in CARMEN and the LMS tool box).
  std::int64_t reply_timeout_ns = 3'000'000'000;
  /// From ACK to the reply to a change of the rate, after which the line changes in any case.
  std::int64_t baud_reply_timeout_ns = 300'000'000;
  /// Rest before a command is repeated (30 ms in MIRO).
  std::int64_t repeat_gap_ns = 30'000'000;
  /// How often a command is sent before it counts as failed.
  int tries = 3;
  /// Rest after a change of the rate (0.25 s in the SICK tool box, up to 3 s elsewhere).
  std::int64_t settle_ns = 250'000'000;
  /// How often a change of the rate is tried before the sensor is used at the rate that it has.
  int baud_switch_tries = 2;
  /// Silence within a telegram that ends it (35 ms in the LMS tool box).
  std::int64_t byte_gap_ns = 35'000'000;
  /// Silence after which a rate is given up while looking for the sensor.
  std::int64_t detection_quiet_ns = 120'000'000;
  /// Rest after a search without success, doubled each time up to the second.
  std::int64_t first_pause_ns = 250'000'000;
  std::int64_t longest_pause_ns = 5'000'000'000;
  /// After so many searches without success the state is failed; the search goes on.
  int searches_until_failed = 3;
  /// Without a scan for so many scan periods, and at least this time, the sensor is searched for
  /// anew.
  int silent_scan_periods = 4;
  std::int64_t shortest_silence_ns = 1'000'000'000;

  // Scans.
  /// One turn of the mirror (25 Hz in a node for a real PLS 200; not confirmed on hardware).
  std::int64_t scan_period_ns = 40'000'000;
  /// From the middle of the sweep to the first byte of its telegram: the half of the 180 deg that
  /// the mirror sweeps in half a turn. Not confirmed on hardware.
  std::int64_t sweep_to_send_ns = 10'000'000;
  /// Readings from here on are no return. CARMEN uses 50 m for the PLS.
  double range_max_m = 50.0;
  /// Codes from here on are no return, whatever the unit (8183 and above in an LMS; the codes
  /// of a PLS are not confirmed on hardware).
  std::uint16_t first_no_return_code = 8183;
  /// What a dazzled reading counts as: no return, or its distance.
  bool dazzled_is_no_return = true;
  /// Drops scans that the sensor itself calls implausible, or with an error or a fatal error.
  bool drop_implausible = true;
  bool drop_at_error = true;
  /// From this many identical scans in a row on, they are dropped: a window that is covered or a
  /// sensor that hangs. 2 drops every repetition, 0 none. That the noise of a PLS makes scans of a
  /// standing robot differ is not confirmed on hardware, hence the default.
  int stuck_scans = 25;
  /// Scans with fewer returns may repeat: there is nothing to see.
  std::size_t stuck_returns = 10;

  /// Throws std::invalid_argument naming the first setting that is out of range.
  void check() const;
};

}  // namespace topogeo::devices
