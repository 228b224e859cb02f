#include "topogeo/devices/rwi_driver.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/devices/base_limits.hpp"

namespace topogeo::devices {
namespace {

/// Voltages outside of these are line errors, as in BeeSoft, MIRO and CMU's B21 driver.
constexpr double kLeastVolts = 1.0;
constexpr double kMostVolts = 100.0;
/// The MCP reports the voltage in tenths.
constexpr double kVoltsPerUnit = 0.1;

const BaseSettings& checked_base(const BaseSettings& settings) {
  check(settings);
  return settings;
}

/// The first bit requests the mask itself, which only binary reports contain.
bool same_fields(std::uint32_t mask, std::uint32_t wanted) {
  return ((mask ^ wanted) & ~mask_bit(McpField::kMask)) == 0;
}

}  // namespace

RwiDriver::RwiDriver(const BaseSettings& settings)
    : settings_(checked_base(settings)),
      decoder_(settings),
      odometer_(settings),
      motion_(McpUnits(settings.calibration), settings.limits),
      monitor_(McpUnits(settings.calibration), settings),
      term_(settings),
      interlocks_(settings),
      writer_(settings),
      link_(settings, writer_),
      upkeep_(settings) {
  update_status();
}

void RwiDriver::opened(std::int64_t now_ns) {
  decoder_.reset();
  link_.open(now_ns);
  follow(BaseLink::Change::kSetUp, now_ns);
  tick(now_ns);
}

void RwiDriver::lost(std::int64_t now_ns) {
  link_.close();
  orders_written_ = true;  // they are lost with the port
  follow(BaseLink::Change::kOffline, now_ns);
  update_status();
}

void RwiDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (link_.closed() || bytes.empty()) return;
  for (const McpMessage& message : decoder_.decode(bytes)) {
    std::visit([&](const auto& content) { take(content, now_ns); }, message);
  }
  follow(link_.received(bytes, now_ns), now_ns);
  tick(now_ns);
}

void RwiDriver::tick(std::int64_t now_ns) {
  if (term_.expired(now_ns)) stand(now_ns);
  interlocks_.tick(now_ns);
  follow(link_.tick(now_ns), now_ns);
  if (guard_ && term_.velocity_holds() && now_ns >= judge_ns_) judge_again(now_ns);
  idle_ = !link_.closed() && now_ns >= writer_.free_ns() && !write_next(now_ns);
  confirm_aim(now_ns);
  update_status();
}

std::int64_t RwiDriver::due_ns() const {
  if (link_.closed()) return link_.due_ns();
  std::int64_t due_ns = std::min({term_.due_ns(), interlocks_.due_ns(), link_.due_ns()});
  if (guard_ && term_.velocity_holds()) due_ns = std::min(due_ns, judge_ns_);
  if (!link_.running()) return due_ns;
  // Another write may be due as soon as the line is free, because motion has no schedule of its
  // own.
  const std::int64_t next_ns =
      idle_ ? std::max(upkeep_.due_ns(), writer_.free_ns()) : writer_.free_ns();
  return std::min(due_ns, next_ns);
}

std::vector<LineOrder> RwiDriver::take_orders() {
  std::vector<LineOrder> orders = writer_.take_orders();
  if (!orders.empty()) orders_written_ = false;
  return orders;
}

void RwiDriver::confirm_aim(std::int64_t now_ns) {
  if (aim_ordered_ && orders_written_ && !writer_.has_orders()) monitor_.written(now_ns);
}

void RwiDriver::aim_at(const BaseVelocity& velocity, std::int64_t now_ns) {
  aim_ordered_ = false;
  monitor_.aim_at(velocity, motion_.limits(), now_ns);
}

std::vector<BaseOdometry> RwiDriver::take_odometry() {
  return std::exchange(odometry_, {});
}

void RwiDriver::follow(BaseLink::Change change, std::int64_t now_ns) {
  switch (change) {
    case BaseLink::Change::kNone:
      break;
    case BaseLink::Change::kSetUp:
      motion_.want_halt();
      motion_.forget();
      monitor_.restart(now_ns);
      upkeep_.set_up(now_ns);
      break;
    case BaseLink::Change::kRunning:
      upkeep_.refresh(now_ns);
      break;
    case BaseLink::Change::kResumed:
      motion_.forget();
      monitor_.restart(now_ns);
      upkeep_.refresh(now_ns);
      break;
    case BaseLink::Change::kOffline:
      stand(now_ns);
      interlocks_.offline();
      break;
  }
}

void RwiDriver::take(const McpReport& report, std::int64_t now_ns) {
  if (!same_fields(report.mask, settings_.report_mask)) {
    ++implausible_;
    return;
  }
  const BaseOdometer::Result result = odometer_.take(report, now_ns);
  if (result.verdict == BaseOdometer::Verdict::kImplausible) {
    ++implausible_;
    return;
  }
  ++status_.reports;
  odometry_.push_back(result.odometry);
  const bool restarted = result.verdict == BaseOdometer::Verdict::kRestarted;
  if (restarted) {
    ++status_.restarts;
    motion_.forget();
    monitor_.restart(now_ns);
  }
  follow(link_.reported(restarted, now_ns), now_ns);
  monitor_.take(report, motion_, result.odometry.stamp_ns, now_ns);
  if (report.has(McpField::kBumpers)) bump(report.word(McpField::kBumpers), now_ns);
  if (link_.running()) check_motion(now_ns);
}

void RwiDriver::take(const McpEvent& event, std::int64_t now_ns) {
  if (interlocks_.motor_event(event.kind)) {
    upkeep_.acknowledge();
    if (motion_.moves()) interlocks_.emergency_stop();
    stand(now_ns);
  }
  switch (event.kind) {
    case McpEventKind::kBump:
      bump(static_cast<std::uint16_t>(event.value), now_ns);
      break;
    case McpEventKind::kBatteryLow:
      status_.battery_low = true;
      break;
    case McpEventKind::kWatchdogExpired:
      ++status_.watchdog_expirations;
      if (link_.running() && motion_.moves()) interlocks_.watchdog_expired(now_ns);
      monitor_.forget_power();
      stand_again(now_ns);
      upkeep_.refresh(now_ns);
      break;
    case McpEventKind::kLostSync:
      // The base did not understand the last write.
      link_.answered();
      if (!link_.running()) break;
      writer_.queue_sync();
      motion_.forget();
      upkeep_.refresh(now_ns);
      break;
    default:
      break;
  }
}

/// A pressed bumper has stopped the base, which has not lost its power.
void RwiDriver::bump(std::uint16_t active_low, std::int64_t now_ns) {
  if (!interlocks_.bumpers(active_low, motion_.aim().linear_mps, now_ns)) return;
  monitor_.forget_power();
  stand_again(now_ns);
}

void RwiDriver::take(const McpAnswer& answer, std::int64_t /*now_ns*/) {
  link_.answered();
  if (answer.command != McpCommand::kBatteryVoltage) return;
  const double battery_v = kVoltsPerUnit * answer.value;
  if (battery_v < kLeastVolts || battery_v > kMostVolts) return;
  status_.battery_v = battery_v;
  status_.battery_low = battery_v < settings_.battery_low_v;
}

/// Compares the motion of the base with its commands.
void RwiDriver::check_motion(std::int64_t now_ns) {
  if (monitor_.stalled() && interlocks_.emergency_stop()) stand_again(now_ns);
  if (interlocks_.joystick(monitor_.joystick())) stand_again(now_ns);
  if (term_.relative_ended(monitor_.reports_standing(), now_ns)) stand(now_ns);
  const bool runs_on =
      !motion_.moves() && !monitor_.stands() && !monitor_.slows_down() && !monitor_.joystick();
  if (runs_on) motion_.forget_run();
  if (monitor_.disobeys() && !term_.relative_holds()) motion_.forget();
}

bool RwiDriver::commands_taken() const {
  return link_.running() && !interlocks_.engaged() && !monitor_.joystick();
}

bool RwiDriver::accept_motion(double linear_mps, std::int64_t now_ns) {
  interlocks_.motion_commanded(now_ns);
  if (!commands_taken() || interlocks_.pushes(linear_mps)) return false;
  interlocks_.motion_taken();
  term_.clear();
  return true;
}

bool RwiDriver::command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
                        std::int64_t now_ns) {
  require_finite("linear_mps", linear_mps);
  require_finite("angular_radps", angular_radps);
  if (linear_mps != 0.0 || angular_radps != 0.0) {
    if (!accept_motion(linear_mps, now_ns)) return false;
    term_.start_velocity(valid_until_ns, now_ns);
  } else {
    interlocks_.standing_taken();
    term_.clear();
  }
  wanted_ = {linear_mps, angular_radps};
  motion_.want_velocity(guarded(now_ns));
  aim_changed(now_ns);
  return true;
}

void RwiDriver::guard_velocities(VelocityGuard guard, std::int64_t period_ns) {
  guard_ = std::move(guard);
  judge_period_ns_ = period_ns;
}

/// The part of the wanted velocity that the guard allows now.
BaseVelocity RwiDriver::guarded(std::int64_t now_ns) {
  if (!guard_) return wanted_;
  judge_ns_ = now_ns + judge_period_ns_;
  return guard_(wanted_, now_ns);
}

void RwiDriver::judge_again(std::int64_t now_ns) {
  motion_.want_velocity(guarded(now_ns));
  aim_at(motion_.aim(), now_ns);
}

bool RwiDriver::advance(double distance_m, std::int64_t valid_until_ns, std::int64_t now_ns) {
  require_finite("distance_m", distance_m);
  if (!accept_motion(distance_m, now_ns)) return false;
  motion_.want_distance(distance_m);
  start_relative(valid_until_ns, now_ns);
  return true;
}

bool RwiDriver::turn(double angle_rad, std::int64_t valid_until_ns, std::int64_t now_ns) {
  require_finite("angle_rad", angle_rad);
  if (!accept_motion(0.0, now_ns)) return false;
  motion_.want_turn(angle_rad);
  start_relative(valid_until_ns, now_ns);
  return true;
}

void RwiDriver::start_relative(std::int64_t valid_until_ns, std::int64_t now_ns) {
  if (motion_.moves()) term_.start_relative(valid_until_ns);
  aim_changed(now_ns);
  monitor_.leave_power(motion_.limits(), now_ns);
}

void RwiDriver::aim_changed(std::int64_t now_ns) {
  aim_at(motion_.aim(), now_ns);
  tick(now_ns);
}

/// Ends all motion; the halts are written next.
void RwiDriver::stand(std::int64_t now_ns) {
  term_.clear();
  motion_.want_halt();
  aim_at({}, now_ns);
}

/// Like stand(), but sends the halts even if they were sent before.
void RwiDriver::stand_again(std::int64_t now_ns) {
  stand(now_ns);
  motion_.forget();
}

void RwiDriver::halt(std::int64_t now_ns) {
  interlocks_.halt();
  stand_again(now_ns);
  tick(now_ns);
}

void RwiDriver::reset_stop(std::int64_t now_ns) {
  interlocks_.release();
  monitor_.forget_power();
  stand(now_ns);
  tick(now_ns);
}

void RwiDriver::set_limits(const BaseLimits& limits, std::int64_t now_ns) {
  motion_.set_limits(within(limits, settings_.limits));
  if (term_.velocity_holds()) motion_.want_velocity(guarded(now_ns));
  aim_changed(now_ns);
}

/// Writes the next command that is due; false if there is none.
bool RwiDriver::write_next(std::int64_t now_ns) {
  if (writer_.write_queued(now_ns)) return true;
  if (!link_.running()) return false;
  const std::optional<McpOrder> order = next_order(now_ns);
  if (order) writer_.write(*order, now_ns);
  return order.has_value();
}

/// Halts first, then the watchdog, which halts the base if this program fails.
std::optional<McpOrder> RwiDriver::next_order(std::int64_t now_ns) {
  if (const auto halt = motion_.next_halt()) return halt;
  if (const auto watchdog = upkeep_.next_refresh(now_ns)) return watchdog;
  if (const auto order = motion_.next()) {
    if (motion_.relative_sent()) term_.relative_sent(now_ns);
    return order;
  }
  aim_ordered_ = true;
  return upkeep_.next(motion_, now_ns);
}

bool RwiDriver::stands() const {
  return reports_at_halt_ && status_.reports > *reports_at_halt_ && monitor_.stands();
}

void RwiDriver::update_status() {
  if (!motion_.halt_sent()) {
    reports_at_halt_.reset();
  } else if (!reports_at_halt_) {
    reports_at_halt_ = status_.reports;
  }
  status_.stands = link_.running() && stands();
  status_.bumpers = interlocks_.pressed();
  status_.starts = link_.starts();
  status_.state = state();
  status_.reason = reason();
  status_.commands_taken = commands_taken();
  status_.echoes = decoder_.echoes();
  status_.checksum_warnings = decoder_.checksum_warnings();
  status_.drops = decoder_.drops();
  count_of(status_.drops, McpDrop::kImplausible) = implausible_;
}

BaseState RwiDriver::state() const {
  if (link_.offline()) return BaseState::kOffline;
  if (!link_.running()) return BaseState::kStarting;
  if (const auto stopped = interlocks_.state()) return *stopped;
  if (monitor_.joystick()) return BaseState::kJoystick;
  if (motion_.moves() || !monitor_.stands()) return BaseState::kMoving;
  if (monitor_.limp() || !interlocks_.motor_fault().empty()) return BaseState::kMotorsOff;
  return BaseState::kReady;
}

std::string RwiDriver::reason() const {
  const BaseState state = status_.state;
  if (state == BaseState::kOffline) return link_.offline() ? link_.reason() : "the gateway ends";
  if (state == BaseState::kBumped && status_.bumpers != 0) return "a bumper is pressed";
  const bool motors = state == BaseState::kMotorsOff || state == BaseState::kEmergencyStop;
  if (motors && !interlocks_.motor_fault().empty()) {
    return std::string(interlocks_.motor_fault());
  }
  return std::string(base_state_reason(state));
}

}  // namespace topogeo::devices
