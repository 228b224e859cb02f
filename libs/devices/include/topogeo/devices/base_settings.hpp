// Values that differ between bases or are not confirmed on hardware.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/devices/create_settings.hpp"
#include "topogeo/devices/kobuki_settings.hpp"
#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/devices/mcp_units.hpp"
#include "topogeo/devices/pioneer_settings.hpp"
#include "topogeo/devices/roboteq_settings.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/text_base_settings.hpp"
#include "topogeo/devices/vesc_settings.hpp"
#include "topogeo/geometry/reaction_times.hpp"

namespace topogeo::devices {

enum class BaseDialect : std::uint8_t { kAscii, kBinary };

/// Largest speeds, and accelerations in both directions; each > 0.
struct BaseLimits {
  double linear_mps = 0.5;
  double angular_radps = 1.0;
  double linear_mps2 = 0.5;
  double angular_radps2 = 1.0;
};

/// Along x of the robot and counter-clockwise.
struct BaseVelocity {
  double linear_mps = 0.0;
  double angular_radps = 0.0;
  bool operator==(const BaseVelocity&) const = default;
};

struct BaseModel;

struct BaseSettings {
  const BaseModel* model = nullptr;  ///< a row of base_models(); none: the first
  BaseDialect dialect = BaseDialect::kAscii;
  /// 9600 in most sources; one B21 uses 38400.
  LineSettings line{};
  McpCalibration calibration{};
  TextBaseSettings text{};  ///< of a microcontroller
  CreateSettings create{};  ///< of a Create 2
  KobukiSettings kobuki{};
  PioneerSettings pioneer{};
  RoboteqSettings roboteq{};
  VescSettings vesc{};
  /// BaseDriver::set_limits cannot exceed them.
  BaseLimits limits{};

  /// Fields of the reports (McpField): at least clock, x, y, heading, and speed and status of both
  /// axes.
  std::uint32_t report_mask = 0x000A0A7A;
  /// 0: as short as the line allows, at least 26/256 s, below which a base does not go (MIRO's
  /// driver).
  double report_period_s = 0.0;
  McpChecksum checksum = McpChecksum::kLearn;

  /// The base stops by itself if its watchdog is not refreshed for this long; the driver refreshes
  /// it five times as often. (0, 255]. It is not confirmed on hardware whether the base then halts
  /// or goes limp. Guards rely on this time (geometry/reaction_times.hpp).
  double watchdog_s = geometry::kBaseWatchdog_s;
  /// A motion command holds no longer than this. (0, 0.5]
  double command_timeout_s = 0.5;
  /// A base without a usable report for this long is offline; at least four periods.
  double silence_s = 0.5;
  /// Between two commands; a base loses commands that follow sooner (MIRO's driver).
  double write_gap_s = 0.01;
  /// Between the request for the binary dialect and the first packet.
  double direct_mode_wait_s = 0.25;

  /// The joystick stays usable while the driver runs. Without it an operator has to push the robot.
  bool joystick_allowed = true;
  /// The base stops by itself when it bumps (BE 0; the argument is not confirmed on hardware).
  bool stop_on_bump = true;
  /// Motor torque limits (TT); empty: unchanged.
  std::optional<std::uint8_t> torque{};
  /// Delay between an error of the motors and their shutdown (ED), 1/256 s.
  std::uint16_t error_delay_ticks = 0x80;

  /// Number of successive reports of acceleration at standstill, though more than three times the
  /// standstill speed was commanded, that count as an emergency stop: the base has no known message
  /// for it. >= 2
  unsigned stalled_reports = 3;
  /// Lower speeds count as standstill; encoder noise of a base at rest reaches 256 counts/s.
  double standstill_mps = 0.01;
  double standstill_radps = 0.03;
  /// A motor with power keeps the commanded speed within the ripple, and lags behind its
  /// acceleration by the ramp at most; a slower motor has lost its power (power_watch.hpp). Smaller
  /// values would react to noise, larger ones would hide short emergency stops.
  double ripple_mps = 0.012;
  double ripple_radps = 0.035;
  double ramp_mps = 0.025;
  double ramp_radps = 0.06;
  /// Motion that exceeds all commands by this much is motion by joystick.
  double uncommanded_mps = 0.05;
  double uncommanded_radps = 0.15;

  double battery_period_s = 10.0;
  double battery_low_v = 44.0;
};

/// Throws std::invalid_argument with the name and range of the first invalid setting.
void check(const BaseSettings& settings);

/// Time between two reports, in 1/256 s, from `report_period_s` or the capacity of the line.
std::uint16_t report_period_ticks(const BaseSettings& settings);
/// Transmission time of a report.
std::int64_t report_line_time_ns(const BaseSettings& settings);

}  // namespace topogeo::devices
