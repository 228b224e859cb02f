// Interface of the driver of a laser: bytes and the time go in; scans, the laser's health and
// orders for the line come out. No port and no clock, see serial_driver.hpp.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

/// The beams of one sweep or turn of the mirror.
struct LaserScan {
  /// The middle of the sweep, on the driver's clock; strictly increasing.
  std::int64_t stamp_ns = 0;
  double angle_min_rad = 0.0;   ///< of the first beam, the rightmost, in the laser frame
  double angle_step_rad = 0.0;  ///< counter-clockwise, > 0
  std::vector<float> ranges_m;  ///< one per beam; 0: no return
  double first_beam_s = 0.0;    ///< time of the first of ranges_m after the stamp
  /// Time from one of ranges_m to the next; negative if the mirror turns clockwise. A driver that
  /// does not know it gives 0, and all beams count as measured at the stamp.
  double time_step_s = 0.0;
  bool contaminated = false;   ///< the window is dirty
  std::size_t dazzled = 0;     ///< readings with glaring light
  bool warning_field = false;  ///< a reading lies in the warning field of the laser itself
  bool protective_field = false;
};

enum class LaserState : std::uint8_t {
  kOffline,   ///< there is no port
  kStarting,  ///< the laser is searched for or set up
  kRunning,   ///< it sends scans
  kFailed     ///< it did not answer several times; the driver keeps trying
};

/// State of a laser, for people and for the programs that use it.
struct LaserHealth {
  LaserState state = LaserState::kOffline;
  std::string reason;  ///< the present step or problem; empty while all is well
  std::string fault;   ///< why the scans of a running laser are of no use; empty: they are usable
  std::string device;  ///< name and version that the laser reports; empty: none
  LineSettings line;   ///< of the port at present
  bool contaminated = false;  ///< the window is dirty
  bool implausible = false;   ///< the laser calls its own measurements implausible
  std::uint16_t error_level =
      0;                  ///< reported by the laser: 0 none, 1 info, 2 warning, 3 error, 4 fatal
  double turns_hz = 0.0;  ///< turns of the mirror a second that the laser reports; 0: unknown
  std::uint64_t searches = 0;  ///< failed attempts to start it
  /// Dropped bytes, telegrams and scans by reason, with the same names for all lasers.
  std::vector<std::pair<std::string, std::uint64_t>> drops;
};

class LaserDriver : public SerialDriver {
 public:
  /// An earlier driver received scans over this line, and ended: the laser may still send them.
  /// Call before the port is opened.
  virtual void resume(const LineSettings& line) { static_cast<void>(line); }
  /// The scans received since the last call, in order.
  [[nodiscard]] virtual std::vector<LaserScan> take_scans() = 0;
  [[nodiscard]] virtual LaserHealth health() const = 0;
  /// The program ends: orders to stop the motor or the stream, where the laser has such.
  virtual void end(std::int64_t now_ns) { static_cast<void>(now_ns); }
};

}  // namespace topogeo::devices
