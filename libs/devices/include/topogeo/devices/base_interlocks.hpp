// Conditions that have stopped a base and prevent further motion: a halt, the emergency stop, its
// watchdog, a bumper, a fault of a motor.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/base_status.hpp"
#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// Stops that hold until an operator releases them.
struct HeldStops {
  bool emergency_stop = false;
  bool halt = false;

  friend bool operator==(const HeldStops&, const HeldStops&) = default;
};

class BaseInterlocks {
 public:
  explicit BaseInterlocks(const BaseSettings& settings);

  /// Motion commands are refused.
  [[nodiscard]] bool engaged() const {
    return ended_ || held_.emergency_stop || held_.halt || bump_latched_;
  }
  /// The resulting state; nothing while the base may move.
  [[nodiscard]] std::optional<BaseState> state() const;

  /// A motion command came, accepted or not: a bump lasts as long as the commands that led to it go
  /// on.
  void motion_commanded(std::int64_t now_ns) { last_motion_command_ns_ = now_ns; }
  /// A motion command is accepted; clears all that a command resets.
  void motion_taken();
  /// A command to stand was accepted, which is always allowed.
  void standing_taken();

  void halt() { held_.halt = true; }
  /// The program that drives the base ends. Nothing releases this, and it is no stop that holds.
  void end() { ended_ = true; }
  /// The base does not move as commanded. False if it was already stopped for that.
  bool emergency_stop();
  /// An operator releases halt and emergency stop.
  void release();
  [[nodiscard]] const HeldStops& held() const { return held_; }
  /// Adds stops that an earlier process has left.
  void hold(const HeldStops& stops);

  /// The base stopped by itself while it was driven. That is no emergency stop: the state lasts
  /// until the next command, or for kWatchdogShown_ns without one.
  void watchdog_expired(std::int64_t now_ns) { watchdog_until_ns_ = now_ns + kWatchdogShown_ns; }
  /// Long enough for people to read it.
  static constexpr std::int64_t kWatchdogShown_ns = 5'000'000'000;
  /// Whether the base moves by joystick; true when that has begun.
  bool joystick(bool moves);
  /// Bumpers of a report or an event, 0 if pressed. True if one more is pressed than before: then
  /// the base has to stop, because going on would push. After a pause in the commands it may move
  /// again, for example to back off.
  /// `linear_mps`: the motion at that moment. Going on in its direction stays refused while a
  /// bumper is pressed, see pushes().
  bool bumpers(std::uint16_t active_low, double linear_mps, std::int64_t now_ns);
  /// Motion with this velocity would push against what presses the bumper.
  [[nodiscard]] bool pushes(double linear_mps) const {
    return pressed_ != 0 && linear_mps * bump_mps_ > 0.0;
  }
  /// A bit for each switch that is pressed.
  [[nodiscard]] std::uint16_t pressed() const { return pressed_; }

  /// Records an event that is a motor fault or clears one. True for a fault.
  bool motor_event(McpEventKind kind);
  /// The motor fault, empty if there is none.
  [[nodiscard]] std::string_view motor_fault() const { return motor_fault_; }

  /// The base does not answer, so the reasons of its stop are no longer known.
  void offline();
  void tick(std::int64_t now_ns);
  [[nodiscard]] std::int64_t due_ns() const;

 private:
  [[nodiscard]] std::int64_t bump_until_ns() const;

  std::int64_t command_timeout_ns_;
  HeldStops held_;
  std::optional<std::int64_t> watchdog_until_ns_{};
  bool ended_ = false;
  bool bump_latched_ = false;
  bool joystick_ = false;
  std::uint16_t pressed_ = 0;
  double bump_mps_ = 0.0;  // when the last bumper was pressed
  std::int64_t last_motion_command_ns_ = 0;
  std::string_view motor_fault_{};
};

}  // namespace topogeo::devices
