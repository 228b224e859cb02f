#include "base_channel.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::sensor_gateway {

using std::chrono::milliseconds;

namespace {

/// Same as for all statuses: twice a second.
constexpr milliseconds kStatusPeriod{500};
/// Longest wait at the end for the base to take the stop command: a slow line needs a tenth of it.
constexpr milliseconds kLongestStop{500};
constexpr milliseconds kStopPoll{10};
/// No command holds for longer, whatever it states: a robot whose navigator hangs must stop.
constexpr double kLongestCommand_s = 0.5;

msg::BaseState to_msg(devices::BaseState state) {
  switch (state) {
    case devices::BaseState::kReady:
      return msg::kBaseReady;
    case devices::BaseState::kMoving:
      return msg::kBaseMoving;
    case devices::BaseState::kStarting:
      return msg::kBaseStarting;
    case devices::BaseState::kEmergencyStop:
      return msg::kBaseEmergencyStop;
    case devices::BaseState::kHalted:
      return msg::kBaseHalted;
    case devices::BaseState::kWatchdogExpired:
      return msg::kBaseWatchdogExpired;
    case devices::BaseState::kBumped:
      return msg::kBaseBumped;
    case devices::BaseState::kJoystick:
      return msg::kBaseJoystick;
    case devices::BaseState::kMotorsOff:
      return msg::kBaseMotorsOff;
    case devices::BaseState::kOffline:
      break;
  }
  return msg::kBaseOffline;
}

/// A base without a watchdog gets a process that stops it after the same time.
PortOptions port_of(const DeviceConfig& config, const devices::BaseDriver& driver) {
  PortOptions port{config.base_port};
  port.stop_bytes = driver.stop_bytes();
  port.stop_after = milliseconds(std::llround(1e3 * config.base.watchdog_s));
  return port;
}

}  // namespace

BaseChannel::BaseChannel(service::Service& service, const DeviceConfig& config,
                         const HostTime& time, const std::optional<RememberedOdometry>& remembered,
                         const std::filesystem::path& stop_memory, Hooks hooks)
    : service_(service),
      time_(time),
      remembered_(remembered),
      hooks_(std::move(hooks)),
      driver_(devices::make_base_driver(config.base)),
      stop_memory_(stop_memory),
      stop_count_(1 + support::unrepeatable_u64() / 2),
      minimum_radius_m_(service.setup().config.config.navigator.guard.minimum_turning_radius_m),
      odometry_(service.advertise<msg::Odometry>()),
      statuses_(service.advertise<msg::BaseStatus>()),
      line_(service.loop(), *driver_, port_of(config, *driver_),
            [this](std::int64_t now_ns) { after_driver(now_ns); }) {
  if (remembered_) driver_->resume_odometry(remembered_->state);
  resume_stops();
  if (!config.laser_port.empty()) {
    guard_.emplace(service.setup().config.config.navigator.guard, config.base.watchdog_s);
  }
  if (guard_ || minimum_radius_m_ > 0.0) {
    driver_->guard_velocities([this](const devices::BaseVelocity& wanted,
                                     std::int64_t now_ns) { return guarded(wanted, now_ns); },
                              navigation::LastGuard::kPeriod_ns);
  }
  service.subscribe<msg::MotionCommand>(
      [this](const msg::MotionCommand& command, const messaging::SampleInfo& info) {
        on_command(command, info);
      });
  service.subscribe<msg::BaseCommand>(
      [this](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
        on_command(command, info);
      });
  timer_ = service.loop().add_timer(kStatusPeriod, [this] { publish_status(); });
}

BaseChannel::~BaseChannel() {
  service_.loop().cancel_timer(timer_);
  if (stopped_ || !line_.is_open()) return;
  // After an exception the loop no longer runs, so the base gets only what the line takes at once.
  // Its watchdog does the rest.
  try {
    driver_->end(line_.now_ns());
    line_.carry_out();
    static_cast<void>(line_.wait_written(kLongestStop));
  } catch (const std::exception& error) {
    spdlog::error("halt not sent: {}", error.what());
  }
}

void BaseChannel::resume_stops() {
  const devices::HeldStops& held = stop_memory_.held();
  if (stop_memory_.damaged()) {
    service_.status().fault("damaged stop memory", "the base is halted until a reset");
  } else if (held.emergency_stop || held.halt) {
    spdlog::warn("{} of before this start: the base moves after a reset",
                 held.emergency_stop ? "emergency stop" : "halt");
  }
  driver_->hold_stops(held);
}

void BaseChannel::begin_epoch(std::int64_t stamp_ns) {
  // If the system's clock was set back meanwhile, others would reject new messages as old.
  const bool resumed =
      remembered_ && driver_->odometry_resumed() && stamp_ns > remembered_->last_stamp_ns;
  odometry_epoch_ = resumed ? remembered_->epoch : support::unrepeatable_u64();
  if (resumed) spdlog::info("the odometry goes on: the base has counted on");
  hooks_.on_epoch(*odometry_epoch_, resumed);
}

void BaseChannel::after_driver(std::int64_t) {
  stop_count_.emergency_stop(driver_->held_stops().emergency_stop);
  if (!stop_memory_.store(driver_->held_stops())) {
    service_.status().fault("stop not stored", "a restarted gateway halts the base");
  }
  for (const devices::BaseOdometry& sample : driver_->take_odometry()) {
    if (!odometry_epoch_) begin_epoch(time_.stamp_ns(sample.stamp_ns));
    msg::Odometry message;
    messaging::set_header(message, service_.robot_id(), time_.stamp_ns(sample.stamp_ns),
                          odometry_sent_);
    message.T_odom_robot(service::to_msg(sample.T_odom_robot));
    message.odometry_epoch(*odometry_epoch_);
    message.linear_mps(sample.linear_mps);
    message.angular_radps(sample.angular_radps);
    if (odometry_.write(message)) {
      ++odometry_sent_;
    } else {
      service_.status().fault("send blocked", "odometry");
    }
    const geometry::OdometrySample odometry{sample.stamp_ns, sample.T_odom_robot, sample.linear_mps,
                                            sample.angular_radps};
    if (guard_) guard_->add(odometry);
    hooks_.on_odometry(odometry);
  }
  if (shown() != published_) publish_status();
}

void BaseChannel::see(const navigation::ScanPoints& scan) {
  if (guard_) guard_->add(scan);
}

devices::BaseVelocity BaseChannel::guarded(const devices::BaseVelocity& wanted,
                                           std::int64_t now_ns) {
  using Verdict = navigation::LastGuard::Verdict;
  const geometry::Velocity asked{wanted.linear_mps, wanted.angular_radps};
  const geometry::Velocity possible = drivable(asked);
  if (!guard_) return {possible.linear_m_per_s, possible.angular_rad_per_s};
  const navigation::LastGuard::Judgement judgement =
      guard_->judge(possible, driver_->limits().linear_mps2, now_ns);
  const bool stops =
      judgement.verdict == Verdict::kObstacle || judgement.verdict == Verdict::kBlind;
  if (stops && judgement.verdict != verdict_) {
    ++guard_stops_;
    spdlog::warn("motion is commanded {}: the base gets none", judgement.verdict == Verdict::kBlind
                                                                   ? "without a fresh scan"
                                                                   : "into what the laser sees");
  }
  verdict_ = judgement.verdict;
  return {judgement.allowed.linear_m_per_s, judgement.allowed.angular_rad_per_s};
}

geometry::Velocity BaseChannel::drivable(const geometry::Velocity& asked) {
  if (minimum_radius_m_ == 0.0) return asked;
  const geometry::Velocity possible = geometry::drivable(asked, minimum_radius_m_);
  constexpr double kRounding_rad_s = 0.01;
  const bool too_tight =
      std::fabs(possible.angular_rad_per_s - asked.angular_rad_per_s) > kRounding_rad_s;
  if (too_tight && !too_tight_) {
    ++tight_turns_;
    spdlog::warn("a turn of less than {} m is commanded: the base {}", minimum_radius_m_,
                 possible.linear_m_per_s == 0.0 ? "stands" : "turns as tightly as it can");
  }
  too_tight_ = too_tight;
  return possible;
}

std::optional<std::int64_t> BaseChannel::age_of(const msg::MotionCommand& command,
                                                const messaging::SampleInfo& info,
                                                std::int64_t now_ns) {
  const std::optional<std::int64_t> age_ns =
      ages_.age_ns(info.writer, command.stamp_ns(), now_ns, time_.stamp_ns(now_ns));
  // A command to stand still is never refused.
  if (command.linear_mps() == 0.0 && command.angular_radps() == 0.0) return 0;
  if (age_ns && *age_ns <= service::CommandAges::kOldest_ns) return age_ns;
  service_.status().add_drops(age_ns ? "old command" : "command of unknown age");
  return std::nullopt;
}

void BaseChannel::on_command(const msg::MotionCommand& command, const messaging::SampleInfo& info) {
  const double valid_s = std::min(command.valid_for_s(), kLongestCommand_s);
  if (!std::isfinite(command.linear_mps()) || !std::isfinite(command.angular_radps()) ||
      !(valid_s > 0.0)) {
    throw std::invalid_argument(std::to_string(command.linear_mps()) + " m/s, " +
                                std::to_string(command.angular_radps()) + " rad/s for " +
                                std::to_string(command.valid_for_s()) + " s");
  }
  const std::int64_t now_ns = line_.now_ns();
  const std::optional<std::int64_t> age_ns = age_of(command, info, now_ns);
  if (!age_ns) {
    ++refused_;
    return;
  }
  const bool taken = driver_->command(command.linear_mps(), command.angular_radps(),
                                      now_ns - *age_ns + std::llround(valid_s * 1e9), now_ns);
  ++(taken ? commands_ : refused_);
  line_.carry_out();
  after_driver(now_ns);
}

void BaseChannel::on_command(const msg::BaseCommand& command, const messaging::SampleInfo& info) {
  const std::int64_t now_ns = line_.now_ns();
  const std::string client = command.client_id().c_str();
  switch (command.kind()) {
    case msg::kBaseHalt:
      spdlog::warn("halted by {}", client);
      driver_->halt(now_ns);
      stop_count_.halt(info.writer);
      break;
    case msg::kBaseReset:
      reset_stop(command, info.writer, now_ns);
      break;
    case msg::kBaseSetLimits:
      try {
        driver_->set_limits(
            {command.largest_linear_mps(), command.largest_angular_radps(),
             command.linear_acceleration_mps2(), command.angular_acceleration_radps2()},
            now_ns);
      } catch (const std::invalid_argument& error) {
        service_.status().fault("invalid limits", client + ": " + error.what());
      }
      break;
  }
  line_.carry_out();
  after_driver(now_ns);
}

void BaseChannel::reset_stop(const msg::BaseCommand& command, const messaging::Handle& writer,
                             std::int64_t now_ns) {
  if (stop_count_.may_release(writer, command.stop_count())) {
    spdlog::warn("{} allows the base to move again", command.client_id().c_str());
    driver_->reset_stop(now_ns);
    return;
  }
  service_.status().add_drops("old reset");
  spdlog::warn("reset of {} refused: the base was stopped again since",
               command.client_id().c_str());
  publish_status();
}

std::string BaseChannel::describe() const {
  const devices::BaseStatus& status = driver_->status();
  const std::string name(devices::base_state_name(status.state));
  if (!line_.why_closed().empty()) return name + ": " + line_.why_closed();
  return status.reason.empty() ? name : name + ": " + status.reason;
}

void BaseChannel::publish_status() {
  const devices::BaseStatus& status = driver_->status();
  published_ = shown();
  msg::BaseStatus message;
  messaging::set_header(message, service_.robot_id(), time_.stamp_ns(line_.now_ns()),
                        statuses_sent_);
  message.state(to_msg(status.state));
  messaging::set_text_cut(message.reason(),
                          !line_.why_closed().empty() ? line_.why_closed() : status.reason);
  message.commands_taken(status.commands_taken);
  message.stands(status.stands);
  message.battery_v(static_cast<float>(status.battery_v));
  message.battery_low(status.battery_low);
  message.bumpers(status.bumpers);
  message.stop_count(published_.stop_count);
  if (statuses_.write(message)) {
    ++statuses_sent_;
  } else {
    service_.status().fault("send blocked", "base status");
  }
}

void BaseChannel::count() {
  messaging::StatusPublisher& status = service_.status();
  const devices::BaseStatus& base = driver_->status();
  const auto set = [&](const std::string& name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  set("odometry_sent", odometry_sent_);
  set("motion_commands", commands_);
  set("motion_commands_refused", refused_);
  set("last_guard_stops", guard_stops_);
  set("too_tight_turns", tight_turns_);
  set("base_port_opened", line_.statistics().opened);
  set("base_starts", base.starts);
  set("base_restarts", base.restarts);
  set("base_watchdog_expirations", base.watchdog_expirations);
  // A counter, because a new field of BaseStatus would be another wire contract.
  if (base.battery_percent) status.set_counter("battery_percent", *base.battery_percent);
  for (std::size_t i = 0; i < devices::kMcpDropKinds; ++i) {
    status.set_drops("base " + std::string(devices::drop_name(static_cast<devices::McpDrop>(i))),
                     base.drops[i]);
  }
}

void BaseChannel::stop() {
  if (std::exchange(stopped_, true)) return;
  driver_->end(line_.now_ns());
  line_.carry_out();
  after_driver(line_.now_ns());
  if (!line_.is_open()) return;
  const auto end = std::chrono::steady_clock::now() + kLongestStop;
  while (line_.is_open() && !driver_->stands() && std::chrono::steady_clock::now() < end) {
    service_.loop().run_for(kStopPoll);
  }
  if (!line_.wait_written(kLongestStop)) {
    service_.status().fault("halt not sent", line_.why_closed());
  }
}

}  // namespace topogeo::sensor_gateway
