// Status of a SICK laser, for people and for the programs that use it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/pls_scan.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_telegram.hpp"

namespace topogeo::devices {

enum class PlsState {
  kOffline,      ///< there is no port
  kDetecting,    ///< the sensor is searched for
  kConfiguring,  ///< it answers, and is being set up
  kRunning,      ///< it sends scans
  kFailed,       ///< several searches have failed; the search goes on
};
[[nodiscard]] const char* to_string(PlsState state);

struct PlsCounters {
  SickCounters line;                        ///< of the decoder
  PlsScanDrops scan_drops;                  ///< of scans received whole
  std::uint64_t scans = 0;                  ///< handed on
  std::uint64_t unsolicited = 0;            ///< scans that came while the sensor was being set up
  std::uint64_t timeouts = 0;               ///< commands without ACK or reply in time
  std::uint64_t repeats = 0;                ///< commands sent again
  std::uint64_t refusals = 0;               ///< commands refused by the sensor
  std::uint64_t restarts = 0;               ///< power-on messages
  std::uint64_t silences = 0;               ///< scans were missing until a new search started
  std::uint64_t searches = 0;               ///< failed searches
  std::uint64_t switches_not_followed = 0;  ///< changes of the rate
  std::uint64_t openings = 0;               ///< of the port
};

struct PlsStatus {
  PlsState state = PlsState::kOffline;
  std::string reason =
      "the port is closed";      ///< the present step or problem; empty while all is well
  LineSettings line;             ///< of the port at present
  bool lms = false;              ///< an LMS, by its parity
  PlsHealth health{};            ///< of the last telegram; polluted: the window is dirty
  bool stuck = false;            ///< scans are dropped because they repeat
  std::string power_on_text;     ///< the sensor's name for itself
  std::string software;          ///< its version; empty if it did not report it
  std::vector<PlsError> errors;  ///< in its memory at start-up
  PlsCounters counters;
};

/// The same in the terms of all lasers.
[[nodiscard]] LaserHealth laser_health(const PlsStatus& status);

}  // namespace topogeo::devices
