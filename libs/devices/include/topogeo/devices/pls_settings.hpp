// All uncertain or adjustable settings of a SICK laser. The values come from published drivers and
// from manufacturer's documents for the LMS; the marked ones are not confirmed on hardware.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

enum class PlsOutput {
  kContinuous,  ///< the sensor sends scan after scan
  kOnRequest,   ///< every scan is requested
};

struct PlsSettings {
  // The line.
  /// The wanted rate: 9600, 19200, 38400 or 500000; 500000 needs an RS-422 line.
  std::uint32_t baud = 500'000;
  /// The rate after power-on unless the owner made another one permanent (all drivers).
  std::uint32_t power_on_baud = 9600;
  /// Rates to search for the sensor at, in this order (BeeSoft's and CARMEN's, then the others).
  std::vector<std::uint32_t> detection_bauds{9600, 38400, 500'000, 19200};
  /// A PLS has even parity, an LMS none; with both, the kind of sensor is detected. All rates are
  /// tried with the first before the second.
  std::vector<Parity> parities{Parity::kEven, Parity::kNone};
  /// Eight characters; an owner may have changed them. The LMS gets its own.
  std::string password_pls = "SICK_PLS";
  std::string password_lms = "SICK_LMS";
  PlsOutput output = PlsOutput::kContinuous;

  // Times. If drivers differ, the value suits the slowest; not confirmed on hardware.
  /// Between the end of a command and ACK or NAK (40 ms by a comment in BeeSoft).
  std::int64_t ack_timeout_ns = 80'000'000;
  /// Between ACK and the reply to a change of mode (3 s in CARMEN and the LMS tool box).
  std::int64_t reply_timeout_ns = 3'000'000'000;
  /// Between ACK and the reply to a change of the rate, after which the line changes in any case.
  std::int64_t baud_reply_timeout_ns = 300'000'000;
  /// Rest before a command is repeated (30 ms in MIRO).
  std::int64_t repeat_gap_ns = 30'000'000;
  /// Number of attempts before a command counts as failed.
  int tries = 3;
  /// Rest after a change of the rate (0.25 s in the SICK tool box, up to 3 s elsewhere).
  std::int64_t settle_ns = 250'000'000;
  /// Number of attempts to change the rate before the sensor is used at its own rate.
  int baud_switch_tries = 2;
  /// Silence within a telegram that ends it (35 ms in the LMS tool box).
  std::int64_t byte_gap_ns = 35'000'000;
  /// Silence after which the search gives up a rate.
  std::int64_t detection_quiet_ns = 120'000'000;
  /// Rest after a failed search, doubled each time up to the second value.
  std::int64_t first_pause_ns = 250'000'000;
  std::int64_t longest_pause_ns = 5'000'000'000;
  /// After this many failed searches the state is failed; the search goes on.
  int searches_until_failed = 3;
  /// After this many scan periods without a scan, and at least the time below, a new search starts.
  int silent_scan_periods = 4;
  std::int64_t shortest_silence_ns = 1'000'000'000;

  // Scans.
  /// One turn of the mirror (25 Hz in a node for a real PLS 200; not confirmed on hardware).
  std::int64_t scan_period_ns = 40'000'000;
  /// Between the middle of the sweep and the first byte of its telegram: half of the 180 deg, which
  /// the mirror sweeps in half a turn. Not confirmed on hardware.
  std::int64_t sweep_to_send_ns = 10'000'000;
  /// Readings from this distance on are no return. CARMEN uses 50 m for the PLS.
  double range_max_m = 50.0;
  /// Codes from this one on are no return, whatever the unit (8183 and above in an LMS; the codes
  /// of a PLS are not confirmed on hardware).
  std::uint16_t first_no_return_code = 8183;
  /// Whether a dazzled reading counts as no return, or as its distance.
  bool dazzled_is_no_return = true;
  /// Drops scans that the sensor itself calls implausible, or with an error or a fatal error.
  bool drop_implausible = true;
  bool drop_at_error = true;
  /// Number of identical scans in a row from which they are dropped: a covered window or a sensor
  /// that hangs. 2 drops every repetition, 0 none. It is not confirmed on hardware that noise makes
  /// a PLS's scans differ while the robot stands, hence the default.
  int stuck_scans = 25;
  /// Scans with fewer returns may repeat, because they show nothing.
  std::size_t stuck_returns = 10;

  /// Throws std::invalid_argument naming the first setting that is out of range.
  void check() const;
};

}  // namespace topogeo::devices
