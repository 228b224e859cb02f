// Interface of the driver of a base: bytes and the time go in; odometry, the state of the base and
// orders for the line come out. No port and no clock, see serial_driver.hpp. Each driver stops its
// base when motion commands cease, and arms what the base has to stop itself when the driver does;
// a base that has nothing is stopped by others with stop_bytes().
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "topogeo/devices/base_interlocks.hpp"
#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/base_status.hpp"
#include "topogeo/devices/body_sensors.hpp"
#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

class BaseDriver : public SerialDriver {
 public:
  /// Drives with these velocities (on the same arc, within the limits) until `valid_until_ns` or
  /// for settings.command_timeout_s, whichever ends first, then halts. False if the command is
  /// refused, see BaseStatus::commands_taken. Both 0 halts and is never refused. Throws
  /// std::invalid_argument for velocities that are not finite.
  virtual bool command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
                       std::int64_t now_ns) = 0;
  /// Last check of velocities: returns the part of a wanted velocity that the base gets now. Called
  /// for each command, and every `period_ns` (> 0) while one holds.
  using VelocityGuard =
      std::function<BaseVelocity(const BaseVelocity& wanted, std::int64_t now_ns)>;
  virtual void guard_velocities(VelocityGuard guard, std::int64_t period_ns) = 0;

  /// Stops now and refuses motion commands until reset_stop().
  virtual void halt(std::int64_t now_ns) = 0;
  /// Stops for good, because the program ends: no command moves the base any more. That is no halt:
  /// held_stops() has only stops by others, also those that come later.
  virtual void end(std::int64_t now_ns) = 0;
  /// Bytes that stop a base which does not stop by itself when no speeds come, for who watches over
  /// a driver that hangs. Empty: the base has a watchdog of its own.
  [[nodiscard]] virtual std::vector<std::uint8_t> stop_bytes() const { return {}; }
  /// The base was told to halt, and has since reported standstill.
  [[nodiscard]] virtual bool stands() const = 0;
  /// An operator permits motion again after halt() or an emergency stop. The base does not move
  /// before the next command.
  virtual void reset_stop(std::int64_t now_ns) = 0;
  /// Stops that only reset_stop() ends. They belong to the robot and not to this process: the
  /// caller stores them for the next driver, which adds them by hold_stops().
  [[nodiscard]] virtual const HeldStops& held_stops() const = 0;
  virtual void hold_stops(const HeldStops& stops) = 0;
  /// Each > 0 and never above those of the settings; effective at once. Throws
  /// std::invalid_argument for limits that are not finite and positive.
  virtual void set_limits(const BaseLimits& limits, std::int64_t now_ns) = 0;
  [[nodiscard]] virtual const BaseLimits& limits() const = 0;

  /// Odometry since the last call; stamps increase strictly over the driver's whole life.
  [[nodiscard]] virtual std::vector<BaseOdometry> take_odometry() = 0;
  [[nodiscard]] virtual const BaseStatus& status() const = 0;
  /// Sonars that the base reads and reports, with their places; null: none. They live as long as
  /// the driver.
  [[nodiscard]] virtual BodySensors* sonars() { return nullptr; }
  [[nodiscard]] virtual std::vector<SonarMount> sonar_mounts() const { return {}; }
  /// Continues the odometry of an earlier driver, see BaseOdometer. A driver whose base does not
  /// show whether it kept counting ignores it.
  virtual void resume_odometry(const OdometerState& state) { static_cast<void>(state); }
  [[nodiscard]] virtual bool odometry_resumed() const { return false; }
  /// Empty before the first odometry, and always for a driver that cannot continue it.
  [[nodiscard]] virtual std::optional<OdometerState> odometer_state() const { return {}; }
};

}  // namespace topogeo::devices
