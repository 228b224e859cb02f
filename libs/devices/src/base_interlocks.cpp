#include "topogeo/devices/base_interlocks.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace topogeo::devices {
namespace {

constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

/// Empty for events that are no motor fault.
std::string_view motor_fault_of(McpEventKind kind) {
  switch (kind) {
    case McpEventKind::kTranslateError:
      return "translation motor: servo error";
    case McpEventKind::kTranslateCurrent:
      return "translation motor: current";
    case McpEventKind::kRotateError:
      return "rotation motor: servo error";
    case McpEventKind::kRotateCurrent:
      return "rotation motor: current";
    default:
      return {};
  }
}

bool clears_motor_fault(McpEventKind kind) {
  return kind == McpEventKind::kTranslateCleared || kind == McpEventKind::kRotateCleared ||
         kind == McpEventKind::kErrorCleared;
}

}  // namespace

BaseInterlocks::BaseInterlocks(const BaseSettings& settings)
    : command_timeout_ns_(static_cast<std::int64_t>(settings.command_timeout_s * 1e9)) {}

std::optional<BaseState> BaseInterlocks::state() const {
  if (held_.emergency_stop) return BaseState::kEmergencyStop;
  if (held_.halt) return BaseState::kHalted;
  if (ended_) return BaseState::kOffline;
  if (watchdog_until_ns_) return BaseState::kWatchdogExpired;
  if (bump_latched_ || pressed_ != 0) return BaseState::kBumped;
  return std::nullopt;
}

void BaseInterlocks::motion_taken() {
  motor_fault_ = {};
  watchdog_until_ns_.reset();
}

void BaseInterlocks::standing_taken() {
  bump_latched_ = false;
  watchdog_until_ns_.reset();
}

bool BaseInterlocks::emergency_stop() {
  return !std::exchange(held_.emergency_stop, true);
}

void BaseInterlocks::release() {
  held_ = {};
}

void BaseInterlocks::hold(const HeldStops& stops) {
  held_.halt = held_.halt || stops.halt;
  held_.emergency_stop = held_.emergency_stop || stops.emergency_stop;
}

bool BaseInterlocks::joystick(bool moves) {
  const bool moved = std::exchange(joystick_, moves);
  return moves && !moved;
}

bool BaseInterlocks::bumpers(std::uint16_t active_low, double linear_mps, std::int64_t now_ns) {
  const auto pressed = static_cast<std::uint16_t>(~active_low);
  const bool more = (pressed & ~pressed_) != 0;
  pressed_ = pressed;
  if (!more) return false;
  bump_latched_ = true;
  bump_mps_ = linear_mps;
  last_motion_command_ns_ = now_ns;
  return true;
}

bool BaseInterlocks::motor_event(McpEventKind kind) {
  const std::string_view fault = motor_fault_of(kind);
  if (!fault.empty() || clears_motor_fault(kind)) motor_fault_ = fault;
  return !fault.empty();
}

void BaseInterlocks::offline() {
  watchdog_until_ns_.reset();
  bump_latched_ = false;
  motor_fault_ = {};
}

void BaseInterlocks::tick(std::int64_t now_ns) {
  if (now_ns >= bump_until_ns()) bump_latched_ = false;
  if (watchdog_until_ns_ && now_ns >= *watchdog_until_ns_) watchdog_until_ns_.reset();
}

std::int64_t BaseInterlocks::bump_until_ns() const {
  return bump_latched_ ? last_motion_command_ns_ + command_timeout_ns_ : kNever_ns;
}

std::int64_t BaseInterlocks::due_ns() const {
  return std::min(bump_until_ns(), watchdog_until_ns_.value_or(kNever_ns));
}

}  // namespace topogeo::devices
