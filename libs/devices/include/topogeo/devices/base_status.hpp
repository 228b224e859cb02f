// Status of a base, for people and for the programs that drive it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// If several states apply, the first one from kOffline to kMotorsOff counts.
enum class BaseState : std::uint8_t {
  kReady,            ///< accepts motion commands and stands still
  kMoving,           ///< moves as commanded
  kOffline,          ///< the line is closed, the base does not answer, or end() was called
  kStarting,         ///< is being set up
  kEmergencyStop,    ///< the motors are without power; until reset_stop()
  kHalted,           ///< halt() was called; until reset_stop()
  kWatchdogExpired,  ///< the base has stopped by itself; until the next motion command, at most 5 s
  kBumped,           ///< a bumper is pressed, or was and the commands that led to it go on
  kJoystick,         ///< moves by its joystick, without a command
  kMotorsOff         ///< the motors are limp, or one of them has a fault
};
std::string_view base_state_name(BaseState state);
/// A general text for the state, used without a specific reason; empty for kReady and kMoving.
std::string_view base_state_reason(BaseState state);

struct BaseStatus {
  BaseState state = BaseState::kOffline;
  std::string reason;           ///< for people; empty when ready or moving
  bool commands_taken = false;  ///< false: motion commands are refused, see state
  bool stands = false;          ///< see BaseDriver::stands(); false while the base is not heard
  double battery_v = 0.0;       ///< 0 until the base reports it
  bool battery_low = false;
  std::optional<double> battery_percent{};  ///< [0, 100]; empty unless the base measures it
  std::uint16_t bumpers = 0;                ///< a bit for each switch that is pressed
  // Counts since the driver was made:
  std::uint64_t reports = 0;            ///< accepted reports
  std::uint64_t echoes = 0;             ///< lines that repeated one of our commands
  std::uint64_t checksum_warnings = 0;  ///< frames accepted in spite of their checksum
  std::uint64_t restarts = 0;  ///< restarts of the base, detected by its clock or registers
  std::uint64_t starts = 0;    ///< number of setups of the base
  std::uint64_t watchdog_expirations = 0;
  McpDrops drops{};  ///< see drop_name()
};

}  // namespace topogeo::devices
