// What an RWI base is doing and what it has reported, for people and for the programs that drive
// it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// Where more than one holds, the first of the list from kOffline to kMotorsOff.
enum class BaseState : std::uint8_t {
  kReady,            ///< takes motion commands and stands still
  kMoving,           ///< is in motion as commanded
  kOffline,          ///< no line to the base, or it does not answer
  kStarting,         ///< is being set up
  kEmergencyStop,    ///< motion was commanded and the motors have no power; until reset_stop()
  kHalted,           ///< by halt(); until reset_stop()
  kWatchdogExpired,  ///< the base has stopped by itself; until the next motion command, at most 5 s
  kBumped,           ///< a bumper is pressed, or was and the commands that led to it go on
  kJoystick,         ///< moves without a command
  kMotorsOff         ///< the motors are limp, or one of them has a fault
};
std::string_view base_state_name(BaseState state);
/// What the state means, where nothing more is known; empty for kReady and kMoving.
std::string_view base_state_reason(BaseState state);

struct BaseStatus {
  BaseState state = BaseState::kOffline;
  std::string reason;           ///< for people; empty when ready or moving
  bool commands_taken = false;  ///< false: motion commands are refused, see state
  double battery_v = 0.0;       ///< 0 until the base has reported it
  bool battery_low = false;
  std::uint16_t bumpers = 0;  ///< a bit for each switch that is pressed
  // Since the driver was made:
  std::uint64_t reports = 0;            ///< that were used
  std::uint64_t echoes = 0;             ///< lines that repeated one of our commands
  std::uint64_t checksum_warnings = 0;  ///< frames that were taken in spite of their checksum
  std::uint64_t restarts = 0;           ///< of the base, seen by its clock or registers
  std::uint64_t starts = 0;             ///< times that the driver set the base up
  std::uint64_t watchdog_expirations = 0;
  McpDrops drops{};  ///< see drop_name()
};

}  // namespace topogeo::devices
