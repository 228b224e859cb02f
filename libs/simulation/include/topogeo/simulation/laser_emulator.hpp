// An emulated laser of any model at the other end of a serial line, with faults on demand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/simulation/serial_device.hpp"

namespace topogeo::simulation {

/// Faults that every emulated laser knows.
enum class LaserFault : std::uint8_t {
  kBadChecksum,  ///< a bit of a telegram changes on the line
  kTruncated,    ///< telegrams end early
  kGarbage,      ///< random bytes after a telegram
  kStuckScan,    ///< old readings are sent again instead of new ones
  kDoubled,      ///< a telegram is sent twice
};
inline constexpr std::size_t kLaserFaults = 5;

class LaserEmulator : public SerialDevice {
 public:
  /// Ranges in metres along `beams` (laser frame, counter-clockwise) at a time; 0 or not finite: no
  /// return.
  using Ranges = std::function<std::vector<float>(const BeamPattern& beams, std::int64_t now_ns)>;

  /// Parity of the line: a pseudo-terminal does not keep that of the host.
  [[nodiscard]] virtual devices::Parity parity() const { return devices::Parity::kNone; }

  virtual void switch_off() = 0;
  virtual void switch_on(std::int64_t now_ns) = 0;
  /// Sends nothing until speak_again(); cuts the bytes on the line.
  virtual void fall_silent(std::int64_t now_ns) = 0;
  virtual void speak_again(std::int64_t now_ns) = 0;
  /// The fault strikes every telegram or scan from now on, or none.
  virtual void set_fault(LaserFault fault, bool on) = 0;
  /// A laser that does not measure the state of its window ignores this.
  virtual void set_contaminated(bool contaminated) { static_cast<void>(contaminated); }
  /// Whole scans sent since the start.
  [[nodiscard]] virtual std::uint64_t scans_sent() const = 0;
};

struct LaserEmulatorSettings {
  const devices::LaserModel* model = nullptr;  ///< a row of laser_models(); none: the first
  /// Fields of a laser that has them, see PlsEmulatorSettings; 0: not set up.
  double protective_field_m = 0.0;
  double warning_field_m = 0.0;
  std::uint64_t seed = 1;  ///< of the places of faults
};

/// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
/// settings.
std::unique_ptr<LaserEmulator> make_laser_emulator(const LaserEmulatorSettings& settings,
                                                   LaserEmulator::Ranges ranges,
                                                   std::int64_t now_ns = 0);

/// The beams of a model's scan.
[[nodiscard]] BeamPattern beams_of(const devices::LaserModel& model);

}  // namespace topogeo::simulation
