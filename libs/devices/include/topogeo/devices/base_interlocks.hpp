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

  /// Whether motion commands are refused.
  [[nodiscard]] bool engaged() const {
    return ended_ || held_.emergency_stop || held_.halt || bump_latched_;
  }
  /// The resulting state; empty while the base may move.
  [[nodiscard]] std::optional<BaseState> state() const;

  /// Records a motion command, accepted or not. A bump lasts until the commands that led to it
  /// pause.
  void motion_commanded(std::int64_t now_ns) { last_motion_command_ns_ = now_ns; }
  /// Records an accepted motion command: clears the motor fault and the expired watchdog.
  void motion_taken();
  /// Records a command of speed 0, which is always accepted: clears the bump and the expired
  /// watchdog.
  void standing_taken();

  void halt() { held_.halt = true; }
  /// Refuses all motion from now on, because the program that drives the base ends. Nothing
  /// releases this; it does not count as a held stop.
  void end() { ended_ = true; }
  /// Records that the base does not move as commanded. Returns false if the emergency stop held
  /// already.
  bool emergency_stop();
  /// Releases halt and emergency stop, by order of an operator.
  void release();
  [[nodiscard]] const HeldStops& held() const { return held_; }
  /// Adds stops that held when an earlier process ended.
  void hold(const HeldStops& stops);

  /// Records that the base stopped by itself while it was driven. This is no emergency stop: the
  /// state lasts until the next command, or for kWatchdogShown_ns without one.
  void watchdog_expired(std::int64_t now_ns) { watchdog_until_ns_ = now_ns + kWatchdogShown_ns; }
  /// This is long enough for people to read the state.
  static constexpr std::int64_t kWatchdogShown_ns = 5'000'000'000;
  /// Sets whether the base moves by joystick. Returns true when such a motion begins.
  bool joystick(bool moves);
  /// Records the bumpers of a report or an event; a bit is 0 while its bumper is pressed. Returns
  /// true if a bumper is newly pressed: the base must stop, because further motion would push.
  /// After a pause in the commands it may move again, for example to back off. `linear_mps`:
  /// velocity at that moment. Motion in its direction stays refused while a bumper is pressed, see
  /// pushes().
  bool bumpers(std::uint16_t active_low, double linear_mps, std::int64_t now_ns);
  /// Whether motion with this velocity would push against the object that presses the bumper.
  [[nodiscard]] bool pushes(double linear_mps) const {
    return pressed_ != 0 && linear_mps * bump_mps_ > 0.0;
  }
  /// The pressed switches, one bit each.
  [[nodiscard]] std::uint16_t pressed() const { return pressed_; }

  /// Records an event that reports or clears a motor fault. Returns true for a fault.
  bool motor_event(McpEventKind kind);
  /// The motor fault; empty if there is none.
  [[nodiscard]] std::string_view motor_fault() const { return motor_fault_; }

  /// Clears watchdog, bump and motor fault, which are unknown while the base does not answer.
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
  double bump_mps_ = 0.0;  // velocity when the last bumper was pressed
  std::int64_t last_motion_command_ns_ = 0;
  std::string_view motor_fault_{};
};

}  // namespace topogeo::devices
