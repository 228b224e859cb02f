// What has stopped a base and keeps it from being driven on: a halt, the emergency stop, its
// watchdog, a bumper, a fault of a motor.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/base_status.hpp"
#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

class BaseInterlocks {
 public:
  explicit BaseInterlocks(const BaseSettings& settings);

  /// Motion commands are refused.
  [[nodiscard]] bool engaged() const { return stopped_ || halted_ || bump_latched_; }
  /// The state that they amount to; nothing while the base may move.
  [[nodiscard]] std::optional<BaseState> state() const;

  /// A motion command came, whether it is taken or not: the bump is not over as long as the
  /// commands that led to it go on.
  void motion_commanded(std::int64_t now_ns) { last_motion_command_ns_ = now_ns; }
  /// A motion command is taken, after all that a command resets.
  void motion_taken();
  /// To stand was commanded, which is always allowed.
  void standing_taken();

  void halt() { halted_ = true; }
  /// The base does not move as commanded. False if it was stopped for that before.
  bool emergency_stop();
  /// An operator releases halt and emergency stop.
  void release();

  /// The base stopped by itself while it was driven. That is no emergency stop: the state holds
  /// until the next command, or for kWatchdogShown_ns where nobody commands.
  void watchdog_expired(std::int64_t now_ns) { watchdog_until_ns_ = now_ns + kWatchdogShown_ns; }
  /// Long enough for people to read it.
  static constexpr std::int64_t kWatchdogShown_ns = 5'000'000'000;
  /// Whether the base moves by joystick; true when that has begun.
  bool joystick(bool moves);
  /// Bumpers of a report or an event, 0 where pressed. True if one more is pressed than before:
  /// then the base has to stop, whoever drives it, as going on would be pushing. Backing off is
  /// free to whoever has noticed.
  bool bumpers(std::uint16_t active_low, std::int64_t now_ns);
  /// A bit for each switch that is pressed.
  [[nodiscard]] std::uint16_t pressed() const { return pressed_; }

  /// Takes note of an event that is the fault of a motor or clears it. True for a fault.
  bool motor_event(McpEventKind kind);
  /// The fault of a motor, empty if there is none.
  [[nodiscard]] std::string_view motor_fault() const { return motor_fault_; }

  /// The base does not answer: what it had stopped for is not known any more.
  void offline();
  void tick(std::int64_t now_ns);
  [[nodiscard]] std::int64_t due_ns() const;

 private:
  [[nodiscard]] std::int64_t bump_until_ns() const;

  std::int64_t command_timeout_ns_;
  bool stopped_ = false;
  bool halted_ = false;
  std::optional<std::int64_t> watchdog_until_ns_{};
  bool bump_latched_ = false;
  bool joystick_ = false;
  std::uint16_t pressed_ = 0;
  std::int64_t last_motion_command_ns_ = 0;
  std::string_view motor_fault_{};
};

}  // namespace topogeo::devices
