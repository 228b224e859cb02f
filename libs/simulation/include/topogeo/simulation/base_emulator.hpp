// An emulated base of any model at the other end of a serial line, with faults on demand. The world
// decides the real motion of the wheels: see commanded_velocity() and moved().
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/simulation/serial_device.hpp"

namespace topogeo::simulation {

/// Faults of the line that every emulated base knows.
enum class BaseFault : std::uint8_t {
  kCorrupted,  ///< a bit of a message changes
  kTruncated,  ///< messages end early
  kSilent,     ///< it sends nothing
  kEcho        ///< it sends back what it receives; a base without an echo ignores it
};

class BaseEmulator : public SerialDevice {
 public:
  /// The emulator was suspended for this time, although its clock went on: its watchdog and its
  /// reports are delayed as much. Call before the next tick.
  virtual void stand_still(std::int64_t duration_ns) = 0;

  // Interface for the world.
  /// Wheel motion as driven by the motors since the last tick; robot frame.
  [[nodiscard]] virtual geometry::Velocity commanded_velocity() const = 0;
  /// Motion measured by the wheels' encoders in the last `time_s`: forward and counter-clockwise.
  virtual void moved(double forward_m, double turn_rad, double time_s) = 0;
  /// Bits of the pressed switches. A base without bumpers ignores it.
  virtual void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) = 0;

  // Interface for the operator.
  /// Both 0: released. A base without a joystick ignores it.
  virtual void take_joystick(const geometry::Velocity& velocity) = 0;
  /// The motors lose their power.
  virtual void press_emergency_stop() = 0;
  virtual void release_emergency_stop() = 0;

  // Faults.
  /// Without power it neither receives nor sends anything, its wheels stand, and all commands and
  /// counts are lost.
  virtual void switch_off(std::int64_t now_ns) = 0;
  /// Switches on, or off and on again: the initial state, after the start-up time.
  virtual void switch_on(std::int64_t now_ns) = 0;
  /// The fault strikes every message from now on, or none.
  virtual void set_fault(BaseFault fault, bool on) = 0;
  /// Sends random bytes.
  virtual void send_garbage(std::size_t bytes, std::int64_t now_ns) = 0;
  /// Sent since the start.
  [[nodiscard]] virtual std::uint64_t reports() const = 0;
};

struct BaseEmulatorSettings {
  const devices::BaseModel* model = nullptr;  ///< a row of base_models(); none: the first
  std::uint32_t baud = 9600;
  std::uint64_t seed = 1;  ///< of the places of faults
};

/// Switched on at `now_ns`.
std::unique_ptr<BaseEmulator> make_base_emulator(const BaseEmulatorSettings& settings,
                                                 std::int64_t now_ns = 0);

}  // namespace topogeo::simulation
