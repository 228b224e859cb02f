// The half of BaseDriver that deals with motion: what is commanded, what stops it, what it amounts
// to as a state.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/devices/base_driver.hpp"

namespace topogeo::devices {
namespace {

/// A relative move has ended when so many reports in succession say that the base stands, none of
/// which can have been taken before it began.
constexpr unsigned kReportsAtRest = 3;
constexpr std::int64_t kBegun_ns = 300'000'000;

constexpr std::array<std::string_view, 10> kStateNames{
    "ready",  "moving",           "offline", "starting", "emergency stop",
    "halted", "watchdog expired", "bumped",  "joystick", "motors off"};

void finite(const char* name, double value) {
  if (std::isfinite(value)) return;
  throw std::invalid_argument("base command: " + std::string(name) + " is not a finite number");
}

double limited(const char* name, double wanted, double largest) {
  if (std::isfinite(wanted) && wanted > 0.0) return std::min(wanted, largest);
  throw std::invalid_argument("base limits: " + std::string(name) + " is " +
                              std::to_string(wanted) + ", not a positive number");
}

}  // namespace

std::string_view base_state_name(BaseState state) {
  return kStateNames.at(static_cast<std::size_t>(state));
}

bool BaseDriver::commands_taken() const {
  return phase_ == Phase::kRunning && !stopped_ && !halted_ && !watch_.joystick() && !bump_latched_;
}

bool BaseDriver::accept_motion(bool motion, std::int64_t now_ns) {
  if (motion) {
    last_motion_command_ns_ = now_ns;
    if (!commands_taken()) return false;
    motor_fault_.clear();
  } else {
    bump_latched_ = false;
  }
  watchdog_expired_ = false;
  primitive_.reset();
  command_until_ns_.reset();
  return true;
}

void BaseDriver::aim_changed(std::int64_t now_ns) {
  watch_.aim_at(motion_.aim(), motion_.limits(), now_ns);
  tick(now_ns);
}

bool BaseDriver::command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
                         std::int64_t now_ns) {
  finite("linear_mps", linear_mps);
  finite("angular_radps", angular_radps);
  const bool motion = linear_mps != 0.0 || angular_radps != 0.0;
  if (!accept_motion(motion, now_ns)) return false;
  const auto timeout_ns = static_cast<std::int64_t>(settings_.command_timeout_s * 1e9);
  if (motion) command_until_ns_ = std::min(valid_until_ns, now_ns + timeout_ns);
  motion_.want_velocity({linear_mps, angular_radps});
  aim_changed(now_ns);
  return true;
}

bool BaseDriver::advance(double distance_m, std::int64_t valid_until_ns, std::int64_t now_ns) {
  finite("distance_m", distance_m);
  if (!accept_motion(true, now_ns)) return false;
  motion_.want_distance(distance_m);
  if (motion_.moves()) primitive_ = Primitive{valid_until_ns};
  aim_changed(now_ns);
  return true;
}

bool BaseDriver::turn(double angle_rad, std::int64_t valid_until_ns, std::int64_t now_ns) {
  finite("angle_rad", angle_rad);
  if (!accept_motion(true, now_ns)) return false;
  motion_.want_turn(angle_rad);
  if (motion_.moves()) primitive_ = Primitive{valid_until_ns};
  aim_changed(now_ns);
  return true;
}

/// Nothing is wanted any more; the halts go out next.
void BaseDriver::stand(std::int64_t now_ns) {
  command_until_ns_.reset();
  primitive_.reset();
  motion_.want_halt();
  watch_.aim_at({}, motion_.limits(), now_ns);
}

void BaseDriver::halt(std::int64_t now_ns) {
  halted_ = true;
  stand(now_ns);
  motion_.forget();
  tick(now_ns);
}

void BaseDriver::reset_stop(std::int64_t now_ns) {
  halted_ = false;
  stopped_ = false;
  stand(now_ns);
  tick(now_ns);
}

void BaseDriver::set_limits(const BaseLimits& limits, std::int64_t now_ns) {
  const BaseLimits& most = settings_.limits;
  motion_.set_limits({limited("linear_mps", limits.linear_mps, most.linear_mps),
                      limited("angular_radps", limits.angular_radps, most.angular_radps),
                      limited("linear_mps2", limits.linear_mps2, most.linear_mps2),
                      limited("angular_radps2", limits.angular_radps2, most.angular_radps2)});
  if (command_until_ns_) motion_.want_velocity(motion_.aim());
  aim_changed(now_ns);
}

void BaseDriver::motor_fault(std::string reason, std::int64_t now_ns) {
  motor_fault_ = std::move(reason);
  acknowledge_ = true;
  stand(now_ns);
}

/// A switch that was not pressed before stops the robot, whoever drives it: going on would be
/// pushing. The way back is free to whoever has noticed.
void BaseDriver::watch_bumpers(std::uint16_t active_low, std::int64_t now_ns) {
  const auto pressed = static_cast<std::uint16_t>(~active_low);
  const bool more = (pressed & ~status_.bumpers) != 0;
  status_.bumpers = pressed;
  if (!more) return;
  bump_latched_ = true;
  last_motion_command_ns_ = now_ns;
  stand(now_ns);
  motion_.forget();
}

void BaseDriver::after_report(std::int64_t now_ns) {
  if (phase_ != Phase::kRunning) return;
  if (watch_.stalled() && !stopped_) {
    stopped_ = true;
    stand(now_ns);
    motion_.forget();
  }
  if (watch_.joystick() && !joystick_halted_) {
    stand(now_ns);
    motion_.forget();
  }
  joystick_halted_ = watch_.joystick();
  if (primitive_ && primitive_->told_ns && now_ns > *primitive_->told_ns + kBegun_ns + period_ns_ &&
      watch_.reports_standing() >= kReportsAtRest) {
    stand(now_ns);
  }
  const bool runs_on =
      !motion_.moves() && !watch_.stands() && !watch_.slows_down() && !watch_.joystick();
  if (runs_on) motion_.forget_run();
  if (watch_.disobeys() && !primitive_) motion_.forget();
}

BaseState BaseDriver::state() const {
  if (phase_ == Phase::kClosed || !offline_reason_.empty()) return BaseState::kOffline;
  if (phase_ != Phase::kRunning) return BaseState::kStarting;
  if (stopped_) return BaseState::kEmergencyStop;
  if (halted_) return BaseState::kHalted;
  if (watchdog_expired_) return BaseState::kWatchdogExpired;
  if (bump_latched_ || status_.bumpers != 0) return BaseState::kBumped;
  if (watch_.joystick()) return BaseState::kJoystick;
  if (motion_.moves() || !watch_.stands()) return BaseState::kMoving;
  if (watch_.limp() || !motor_fault_.empty()) return BaseState::kMotorsOff;
  return BaseState::kReady;
}

std::string BaseDriver::reason() const {
  switch (status_.state) {
    case BaseState::kReady:
    case BaseState::kMoving:
      return {};
    case BaseState::kOffline:
      return offline_reason_;
    case BaseState::kStarting:
      return "the base is being set up";
    case BaseState::kEmergencyStop:
      return "motion was commanded and does not come about: emergency stop, or the wheels are held";
    case BaseState::kHalted:
      return "halted on demand";
    case BaseState::kWatchdogExpired:
      return "the base had heard nothing for too long and stopped";
    case BaseState::kBumped:
      return status_.bumpers != 0 ? "a bumper is pressed" : "a bumper was pressed";
    case BaseState::kJoystick:
      return "the base moves without a command";
    case BaseState::kMotorsOff:
      return motor_fault_.empty() ? "the motors are limp" : motor_fault_;
  }
  return {};
}

bool BaseDriver::stands() const {
  return reports_at_halt_ && status_.reports > *reports_at_halt_ && watch_.stands();
}

void BaseDriver::update_status() {
  if (!motion_.halt_told()) {
    reports_at_halt_.reset();
  } else if (!reports_at_halt_) {
    reports_at_halt_ = status_.reports;
  }
  status_.state = state();
  status_.reason = reason();
  status_.commands_taken = commands_taken();
  status_.drops = std::visit([](const auto& decoder) { return decoder.drops(); }, decoder_);
  count_of(status_.drops, McpDrop::kImplausible) = count_of(implausible_, McpDrop::kImplausible);
  if (const auto* const ascii = std::get_if<McpAsciiDecoder>(&decoder_)) {
    status_.echoes = ascii->echoes();
  } else {
    status_.checksum_warnings = std::get<McpBinaryDecoder>(decoder_).checksum_warnings();
  }
}

}  // namespace topogeo::devices
