#include "topogeo/devices/two_wheel_driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "topogeo/devices/base_limits.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kTwoWheelMs_ns = 1'000'000;
constexpr std::int64_t kAskAgain_ns = 500 * kTwoWheelMs_ns;
/// Speeds are sent this often for each time that the base holds them.
constexpr std::int64_t kRefreshes = 5;
constexpr unsigned kReportsStanding = 2;

BaseSettings checked_two_wheels(const BaseSettings& settings) {
  check(settings);
  return settings;
}

std::int64_t nanoseconds_of(double seconds) {
  return std::llround(seconds * 1e9);
}

/// Moves towards the wanted value by at most `step`.
double approached(double from, double to, double step) {
  return from + std::clamp(to - from, -step, step);
}

}  // namespace

TwoWheelDriver::TwoWheelDriver(const BaseSettings& settings, const WheelUnits& units)
    : settings_(checked_two_wheels(settings)),
      limits_(settings.limits),
      interlocks_(settings),
      term_(settings),
      odometer_(units, settings.limits) {
  status_.reason = reason_;
}

void TwoWheelDriver::opened(std::int64_t now_ns) {
  orders_ = {{settings_.line, {}, {}}};
  forget_bytes();
  disconnect("no answer yet");
  asked_ns_ = now_ns - kAskAgain_ns;
  tick(now_ns);
}

void TwoWheelDriver::lost(std::int64_t /*now_ns*/) {
  disconnect("the port is closed");
  link_ = Link::kClosed;
  orders_.clear();
  update_status();
}

void TwoWheelDriver::disconnect(const std::string& reason) {
  link_ = Link::kAsking;
  reason_ = reason;
  attempts_ = 0;
  heard_ = false;
  odometer_.silent();
  term_.clear();
  wanted_ = sent_ = {};
  at_rest_ = 0;
  interlocks_.offline();
}

void TwoWheelDriver::greet(std::int64_t now_ns) {
  disconnect({});
  ++status_.starts;
  link_ = Link::kRunning;
  last_arrival_ns_ = now_ns;
  sent_ns_ = now_ns - nanoseconds_of(settings_.watchdog_s);
}

void TwoWheelDriver::write(std::vector<std::uint8_t> bytes) {
  orders_.push_back({std::nullopt, std::move(bytes), {}});
}

void TwoWheelDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (link_ == Link::kClosed) return;
  hear(bytes, now_ns);
  tick(now_ns);
}

void TwoWheelDriver::set_battery(double volts, std::optional<double> percent) {
  status_.battery_v = volts;
  status_.battery_percent = percent;
  status_.battery_low = volts < settings_.battery_low_v;
}

void TwoWheelDriver::take(const WheelReport& report, const Signs& signs, std::int64_t now_ns) {
  if (link_ != Link::kRunning) return;
  const WheelOdometer::Verdict verdict = odometer_.take(report, now_ns);
  if (verdict == WheelOdometer::Verdict::kDoubted) {
    ++implausible_;
    return;
  }
  if (verdict == WheelOdometer::Verdict::kRestarted) ++status_.restarts;
  last_arrival_ns_ = now_ns;
  heard_ = true;
  ++status_.reports;
  if (verdict != WheelOdometer::Verdict::kFirst) {
    at_rest_ = odometer_.rests() && sent_ == BaseVelocity{} ? at_rest_ + 1 : 0;
    odometry_.push_back(odometer_.last());
  }
  obey(signs, now_ns);
}

void TwoWheelDriver::obey(const Signs& signs, std::int64_t now_ns) {
  if (signs.emergency_stop && interlocks_.emergency_stop()) {
    emergency_reason_ = *signs.emergency_stop;
    stand(now_ns);
  }
  if (signs.watchdog && term_.velocity_holds()) {
    ++status_.watchdog_expirations;
    interlocks_.watchdog_expired(now_ns);
    stand(now_ns);
  }
  const auto active_low = static_cast<std::uint16_t>(~signs.bumpers);
  if (interlocks_.bumpers(active_low, sent_.linear_mps, now_ns)) stand(now_ns);
}

void TwoWheelDriver::stand(std::int64_t now_ns) {
  term_.clear();
  wanted_ = sent_ = {};
  if (link_ == Link::kRunning) send_speeds(now_ns);
}

/// The base obeys for watchdog_s, so that it stops by itself when this driver does not go on.
void TwoWheelDriver::send_speeds(std::int64_t now_ns) {
  const double passed_s = 1e-9 * static_cast<double>(now_ns - sent_ns_);
  sent_ns_ = now_ns;
  const BaseVelocity allowed =
      within(guard_ && term_.velocity_holds() ? guard_(wanted_, now_ns) : wanted_, limits_);
  const double most_s = std::min(passed_s, settings_.watchdog_s);
  sent_.linear_mps = approached(sent_.linear_mps, allowed.linear_mps, most_s * limits_.linear_mps2);
  sent_.angular_radps =
      approached(sent_.angular_radps, allowed.angular_radps, most_s * limits_.angular_radps2);
  write_speeds(sent_);
}

void TwoWheelDriver::tick(std::int64_t now_ns) {
  if (link_ == Link::kClosed) return;
  if (term_.expired(now_ns)) stand(now_ns);
  interlocks_.tick(now_ns);
  if (link_ == Link::kRunning && now_ns >= last_arrival_ns_ + nanoseconds_of(settings_.silence_s)) {
    disconnect("no report for " + std::to_string((now_ns - last_arrival_ns_) / kTwoWheelMs_ns) +
               " ms");
    asked_ns_ = now_ns - kAskAgain_ns;
  }
  if (link_ == Link::kAsking && now_ns >= asked_ns_ + kAskAgain_ns) {
    asked_ns_ = now_ns;
    ask(attempts_++, now_ns);
  }
  if (link_ == Link::kRunning &&
      now_ns >= sent_ns_ + nanoseconds_of(settings_.watchdog_s) / kRefreshes) {
    send_speeds(now_ns);
  }
  update_status();
}

std::int64_t TwoWheelDriver::due_ns() const {
  if (link_ == Link::kClosed) return std::numeric_limits<std::int64_t>::max();
  const std::int64_t due_ns = std::min(term_.due_ns(), interlocks_.due_ns());
  if (link_ == Link::kAsking) return std::min(due_ns, asked_ns_ + kAskAgain_ns);
  return std::min({due_ns, last_arrival_ns_ + nanoseconds_of(settings_.silence_s),
                   sent_ns_ + nanoseconds_of(settings_.watchdog_s) / kRefreshes});
}

std::vector<LineOrder> TwoWheelDriver::take_orders() {
  return std::exchange(orders_, {});
}

bool TwoWheelDriver::commands_taken() const {
  return link_ == Link::kRunning && heard_ && !interlocks_.engaged() && hindrance().empty();
}

bool TwoWheelDriver::command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
                             std::int64_t now_ns) {
  require_finite("linear_mps", linear_mps);
  require_finite("angular_radps", angular_radps);
  if (linear_mps == 0.0 && angular_radps == 0.0) {
    interlocks_.standing_taken();
    term_.clear();
    wanted_ = {};
  } else {
    interlocks_.motion_commanded(now_ns);
    if (!commands_taken() || interlocks_.pushes(linear_mps)) return false;
    interlocks_.motion_taken();
    term_.start_velocity(valid_until_ns, now_ns);
    wanted_ = {linear_mps, angular_radps};
  }
  tick(now_ns);
  return true;
}

void TwoWheelDriver::guard_velocities(VelocityGuard guard, std::int64_t /*period_ns*/) {
  guard_ = std::move(guard);  // asked at each refresh, more often than any guard needs
}

void TwoWheelDriver::halt(std::int64_t now_ns) {
  interlocks_.halt();
  stand(now_ns);
  if (link_ == Link::kRunning) write_stop();
  tick(now_ns);
}

void TwoWheelDriver::end(std::int64_t now_ns) {
  interlocks_.end();
  ended_ = true;
  stand(now_ns);
  if (link_ == Link::kRunning) write_stop();
  tick(now_ns);
}

void TwoWheelDriver::reset_stop(std::int64_t now_ns) {
  interlocks_.release();
  emergency_reason_.clear();
  stand(now_ns);
  released(now_ns);
  tick(now_ns);
}

void TwoWheelDriver::hold_stops(const HeldStops& stops) {
  interlocks_.hold(stops);
  update_status();
}

void TwoWheelDriver::set_limits(const BaseLimits& limits, std::int64_t now_ns) {
  limits_ = within(limits, settings_.limits);
  tick(now_ns);
}

std::vector<BaseOdometry> TwoWheelDriver::take_odometry() {
  return std::exchange(odometry_, {});
}

BaseState TwoWheelDriver::state() const {
  if (link_ == Link::kClosed || (link_ == Link::kAsking && !reason_.empty())) {
    return BaseState::kOffline;
  }
  if (link_ != Link::kRunning || !heard_) return BaseState::kStarting;
  if (const auto stopped = interlocks_.state()) return *stopped;
  if (!hindrance().empty()) return BaseState::kStarting;
  return status_.stands ? BaseState::kReady : BaseState::kMoving;
}

std::string TwoWheelDriver::reason() const {
  const bool running = link_ == Link::kRunning && heard_;
  if (!running && !reason_.empty()) return reason_;
  if (ended_) return "the gateway ends";
  if (status_.state == BaseState::kEmergencyStop && !emergency_reason_.empty()) {
    return emergency_reason_;
  }
  if (running && status_.state == BaseState::kStarting) return std::string(hindrance());
  return std::string(base_state_reason(status_.state));
}

void TwoWheelDriver::update_status() {
  status_.stands = link_ == Link::kRunning && heard_ && at_rest_ >= kReportsStanding;
  status_.bumpers = interlocks_.pressed();
  status_.commands_taken = commands_taken();
  status_.state = state();
  status_.reason = reason();
  count_drops(status_.drops);
  count_of(status_.drops, McpDrop::kImplausible) = implausible_;
}

}  // namespace topogeo::devices
