// What differs between bases and what is not confirmed on hardware, in one place.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/devices/mcp_units.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/geometry/reaction_times.hpp"

namespace topogeo::devices {

enum class BaseDialect : std::uint8_t { kAscii, kBinary };

/// Largest speeds and the accelerations with which they are reached and left; each > 0.
struct BaseLimits {
  double linear_mps = 0.5;
  double angular_radps = 1.0;
  double linear_mps2 = 0.5;
  double angular_radps2 = 1.0;
};

struct BaseSettings {
  BaseDialect dialect = BaseDialect::kAscii;
  /// 9600 in most sources; one B21 speaks at 38400.
  LineSettings line{};
  McpCalibration calibration{};
  /// BaseDriver::set_limits cannot exceed them.
  BaseLimits limits{};

  /// Fields of the reports (McpField): at least clock, x, y, heading, and speed and status of both
  /// axes.
  std::uint32_t report_mask = 0x000A0A7A;
  /// 0: as short as the line allows, at least 26/256 s, below which a base does not go (MIRO's
  /// driver).
  double report_period_s = 0.0;
  McpChecksum checksum = McpChecksum::kLearn;

  /// The base stops by itself when nothing has refreshed its watchdog for so long; refreshed five
  /// times as often. (0, 255]; whether it halts or goes limp then is not confirmed on hardware.
  /// Guards count on it (geometry/reaction_times.hpp).
  double watchdog_s = geometry::kBaseWatchdog_s;
  /// A motion command holds no longer than this. (0, 0.5]
  double command_timeout_s = 0.5;
  /// A base that gives no usable report for so long is offline; never less than four periods.
  double silence_s = 0.5;
  /// Between two commands; a base loses those that follow sooner (MIRO's driver).
  double write_gap_s = 0.01;
  /// From asking for the binary dialect to the first packet.
  double direct_mode_wait_s = 0.25;

  /// The joystick stays in use while the driver runs. Off, an operator has to push the robot.
  bool joystick_allowed = true;
  /// The base stops by itself when it bumps (BE 0; the argument is not confirmed on hardware).
  bool stop_on_bump = true;
  /// Motor torque limits (TT); nothing: left as they are.
  std::optional<std::uint8_t> torque{};
  /// From an error of the motors to their shutdown (ED), 1/256 s.
  std::uint16_t error_delay_ticks = 0x80;

  /// As many reports in succession of acceleration and standstill, though motion was
  /// commanded at more than three times standstill, are an emergency stop: no message for it is
  /// known. >= 2
  unsigned stalled_reports = 3;
  /// Slower than this counts as standstill; encoder noise of a base at rest reaches 256
  /// counts/s.
  double standstill_mps = 0.01;
  double standstill_radps = 0.03;
  /// A motor with power keeps the commanded speed within the ripple, and lags behind its
  /// acceleration by no more than the ramp; what is slower has lost its power (power_watch.hpp).
  /// Less would take noise for it, more would hide short emergency stops.
  double ripple_mps = 0.012;
  double ripple_radps = 0.035;
  double ramp_mps = 0.025;
  double ramp_radps = 0.06;
  /// Faster by this than anything that was commanded is motion by joystick.
  double uncommanded_mps = 0.05;
  double uncommanded_radps = 0.15;

  double battery_period_s = 10.0;
  double battery_low_v = 44.0;
};

/// Throws std::invalid_argument with the name and range of the setting that is out of it.
void check(const BaseSettings& settings);

/// Between two reports, in 1/256 s, by `report_period_s` or what the line allows.
std::uint16_t report_period_ticks(const BaseSettings& settings);
/// On the line from the first byte of a report to its last.
std::int64_t report_line_time_ns(const BaseSettings& settings);

}  // namespace topogeo::devices
