#include "topogeo/devices/base_driver.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "topogeo/devices/line_time.hpp"

#include "base_start.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// What a base takes at most from the end of the start sequence to its first report, beyond two
/// periods and the report's own time on the line.
constexpr std::int64_t kFirstReportLag_ns = 100'000'000;
/// Between two looks for a silent base: a twentieth of how long it has been silent, within these.
constexpr std::int64_t kShortestProbe_ns = 200'000'000;
constexpr std::int64_t kLongestProbe_ns = 5'000'000'000;
constexpr std::int64_t kProbesPerSilence = 20;
/// A base that has not answered for so long is set up all the same: it may not understand the
/// question. Not sooner, because that makes the reports of one that has just come back start anew.
constexpr std::int64_t kBlindStart_ns = 15 * kSecond_ns;
constexpr double kMostBelievedVolts = 100.0;  // and from 1 V on

std::int64_t nanoseconds(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e9);
}

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

std::variant<McpAsciiDecoder, McpBinaryDecoder> decoder_of(const BaseSettings& settings) {
  if (settings.dialect == BaseDialect::kAscii) return McpAsciiDecoder(settings.report_mask);
  return McpBinaryDecoder(settings.checksum);
}

const BaseSettings& checked_base(const BaseSettings& settings) {
  check(settings);
  return settings;
}

}  // namespace

BaseDriver::BaseDriver(const BaseSettings& settings)
    : settings_(checked_base(settings)),
      units_(settings.calibration),
      period_ns_(ticks_ns(report_period_ticks(settings))),
      decoder_(decoder_of(settings)),
      odometer_(settings),
      motion_(units_, settings.limits),
      watch_(units_, settings) {
  offline_reason_ = "no line to the base";
  update_status();
}

void BaseDriver::opened(std::int64_t now_ns) {
  offline_reason_.clear();
  orders_.clear();
  phase_ = Phase::kClosed;
  heard_ns_ = now_ns;
  free_ns_ = now_ns;
  std::visit([](auto& decoder) { decoder.reset(); }, decoder_);
  start(now_ns);
  tick(now_ns);
}

void BaseDriver::lost(std::int64_t now_ns) {
  go_offline("no line to the base", now_ns);
  phase_ = Phase::kClosed;
  script_.clear();
  orders_.clear();
  update_status();
}

/// Says everything that the base has to know, from the settings of the line on.
void BaseDriver::start(std::int64_t now_ns) {
  reconnects_ = phase_ == Phase::kProbing;
  phase_ = Phase::kStarting;
  ++status_.starts;
  started_ns_ = now_ns;
  answered_ = false;
  script_.clear();
  motion_.want_halt();
  motion_.forget();
  watch_.restart(now_ns);
  battery_ns_ = now_ns;
  const std::int64_t gap_ns = nanoseconds(settings_.write_gap_s);
  const bool binary = settings_.dialect == BaseDialect::kBinary;
  // The line may hold the start of a command already.
  script_.push_back({{settings_.line, bytes_of(binary ? "\rBE FFFF\rDM\r" : "\r")},
                     binary ? nanoseconds(settings_.direct_mode_wait_s) : gap_ns});
  if (binary) script_.push_back({{{}, std::vector<std::uint8_t>(kMcpSyncZeros)}, gap_ns});
  for (const McpOrder& order : set_up_orders(settings_)) {
    Write write{{}, gap_ns};
    if (binary) {
      const McpPacket packet = binary_packet(order);
      write.order.bytes.assign(packet.begin(), packet.end());
    } else {
      append_ascii(order, write.order.bytes);
    }
    script_.push_back(std::move(write));
  }
}

void BaseDriver::run(std::int64_t now_ns) {
  phase_ = Phase::kRunning;
  offline_reason_.clear();
  refresh_ns_ = now_ns;
}

void BaseDriver::go_offline(std::string reason, std::int64_t now_ns) {
  offline_reason_ = std::move(reason);
  stand(now_ns);
  watchdog_expired_ = false;
  bump_latched_ = false;
  motor_fault_.clear();
}

void BaseDriver::probe(std::int64_t now_ns) {
  phase_ = Phase::kProbing;
  phase_until_ns_ = now_ns + std::clamp((now_ns - heard_ns_) / kProbesPerSilence, kShortestProbe_ns,
                                        kLongestProbe_ns);
  probe_answer_.clear();
  // Any base that has just been switched on speaks ASCII.
  write(Write{{{}, bytes_of("\rBV\r")}, nanoseconds(settings_.write_gap_s)}, now_ns);
}

void BaseDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (phase_ == Phase::kClosed || bytes.empty()) return;
  std::vector<McpMessage> messages;
  std::visit([&](auto& decoder) { decoder.decode(bytes, messages); }, decoder_);
  for (const McpMessage& message : messages) {
    std::visit([&](const auto& content) { take(content, now_ns); }, message);
  }
  if (phase_ == Phase::kProbing && answered(bytes)) start(now_ns);
  tick(now_ns);
}

/// A base that echoes, or speaks ASCII though it should not, was switched on anew. Anything else
/// may begin a report, which would say that nothing has to be done.
bool BaseDriver::answered(std::span<const std::uint8_t> bytes) {
  const std::string_view sign = settings_.dialect == BaseDialect::kAscii ? "BV\r" : "BV";
  probe_answer_.append(bytes.begin(), bytes.end());
  if (probe_answer_.find(sign) != std::string::npos) return true;
  probe_answer_.erase(0, probe_answer_.size() - std::min(probe_answer_.size(), sign.size() - 1));
  return false;
}

void BaseDriver::take(const McpReport& report, std::int64_t now_ns) {
  // The first bit says that the mask itself is in the report.
  if (((report.mask ^ settings_.report_mask) & ~1U) != 0) {
    ++count_of(implausible_, McpDrop::kImplausible);
    return;
  }
  const BaseOdometer::Result result = odometer_.take(report, now_ns);
  if (result.verdict == BaseOdometer::Verdict::kImplausible) {
    ++count_of(implausible_, McpDrop::kImplausible);
    return;
  }
  ++status_.reports;
  heard_ns_ = now_ns;
  odometry_.push_back(result.odometry);
  const bool restarted = result.verdict == BaseOdometer::Verdict::kRestarted;
  if (restarted) {
    ++status_.restarts;
    motion_.forget();
    watch_.restart(now_ns);
  }
  const bool again = phase_ == Phase::kProbing || (phase_ == Phase::kStarting && reconnects_);
  if (again && !restarted) {
    // It was silent and goes on as before: no need to set it up again. It may be in the middle of
    // our question.
    script_.clear();
    if (settings_.dialect == BaseDialect::kBinary) {
      script_.push_back(
          {{{}, std::vector<std::uint8_t>(kMcpSyncZeros)}, nanoseconds(settings_.write_gap_s)});
    }
    motion_.forget();
    watch_.restart(now_ns);
    run(now_ns);
  } else if (phase_ == Phase::kWaiting) {
    run(now_ns);
  }
  watch_.take(report, motion_, now_ns);
  if (report.has(McpField::kBumpers)) watch_bumpers(report.word(McpField::kBumpers), now_ns);
  after_report(now_ns);
}

void BaseDriver::take(const McpEvent& event, std::int64_t now_ns) {
  switch (event.kind) {
    case McpEventKind::kBump:
      watch_bumpers(static_cast<std::uint16_t>(event.value), now_ns);
      break;
    case McpEventKind::kBatteryHigh:
      break;
    case McpEventKind::kBatteryLow:
      status_.battery_low = true;
      break;
    case McpEventKind::kTranslateError:
      motor_fault("translation motor: servo error", now_ns);
      break;
    case McpEventKind::kTranslateCurrent:
      motor_fault("translation motor: current", now_ns);
      break;
    case McpEventKind::kRotateError:
      motor_fault("rotation motor: servo error", now_ns);
      break;
    case McpEventKind::kRotateCurrent:
      motor_fault("rotation motor: current", now_ns);
      break;
    case McpEventKind::kTranslateCleared:
    case McpEventKind::kRotateCleared:
    case McpEventKind::kErrorCleared:
      motor_fault_.clear();
      break;
    case McpEventKind::kWatchdogExpired:
      ++status_.watchdog_expirations;
      watchdog_expired_ = phase_ == Phase::kRunning;
      stand(now_ns);
      motion_.forget();
      refresh_ns_ = now_ns;
      break;
    case McpEventKind::kLostSync:
      // What we said last was not understood, whatever it was.
      answered_ = true;
      if (phase_ != Phase::kRunning) break;
      script_.push_front(
          {{{}, std::vector<std::uint8_t>(kMcpSyncZeros)}, nanoseconds(settings_.write_gap_s)});
      motion_.forget();
      refresh_ns_ = now_ns;
      break;
    case McpEventKind::kIndex:
      break;
  }
}

void BaseDriver::take(const McpAnswer& answer, std::int64_t /*now_ns*/) {
  // Unless reports follow, too, it is set up when the next question would be due.
  answered_ = true;
  if (answer.command != McpCommand::kBatteryVoltage) return;
  const double battery_v = 0.1 * answer.value;
  if (battery_v < 1.0 || battery_v > kMostBelievedVolts) return;
  status_.battery_v = battery_v;
  status_.battery_low = battery_v < settings_.battery_low_v;
}

void BaseDriver::tick(std::int64_t now_ns) {
  check_time_outs(now_ns);
  pump(now_ns);
  update_status();
}

void BaseDriver::check_time_outs(std::int64_t now_ns) {
  if (command_until_ns_ && now_ns >= *command_until_ns_) stand(now_ns);
  if (primitive_ && now_ns >= primitive_->until_ns) stand(now_ns);
  if (bump_latched_ &&
      now_ns - last_motion_command_ns_ >= nanoseconds(settings_.command_timeout_s)) {
    bump_latched_ = false;
  }
  if (phase_ == Phase::kStarting && script_.empty() && now_ns >= free_ns_) {
    phase_ = Phase::kWaiting;
    phase_until_ns_ = now_ns + 2 * period_ns_ + report_line_time_ns(settings_) + kFirstReportLag_ns;
  }
  const std::int64_t silence_ns = std::max(nanoseconds(settings_.silence_s), 4 * period_ns_);
  if (phase_ == Phase::kRunning && now_ns >= heard_ns_ + silence_ns) {
    script_.clear();
    go_offline("the base has stopped to report", now_ns);
    probe(now_ns);
  }
  if (phase_ == Phase::kWaiting && now_ns >= phase_until_ns_) {
    go_offline("the base does not answer", now_ns);
    probe(now_ns);
  }
  if (phase_ == Phase::kProbing && now_ns >= phase_until_ns_) {
    if (answered_ || now_ns >= started_ns_ + kBlindStart_ns) {
      start(now_ns);
    } else {
      probe(now_ns);
    }
  }
}

std::int64_t BaseDriver::due_ns() const {
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  if (phase_ == Phase::kClosed) return kNever;
  std::int64_t due_ns = kNever;
  if (command_until_ns_) due_ns = std::min(due_ns, *command_until_ns_);
  if (primitive_) due_ns = std::min(due_ns, primitive_->until_ns);
  if (bump_latched_) {
    due_ns = std::min(due_ns, last_motion_command_ns_ + nanoseconds(settings_.command_timeout_s));
  }
  if (!script_.empty() || phase_ == Phase::kStarting) due_ns = std::min(due_ns, free_ns_);
  if (phase_ == Phase::kWaiting || phase_ == Phase::kProbing) {
    due_ns = std::min(due_ns, phase_until_ns_);
  }
  if (phase_ == Phase::kRunning) {
    // Something to say may come up whenever the line is free again: motion has no time of its own.
    due_ns = std::min({due_ns, std::max(refresh_ns_, free_ns_), std::max(battery_ns_, free_ns_),
                       heard_ns_ + std::max(nanoseconds(settings_.silence_s), 4 * period_ns_)});
    if (more_to_say_) due_ns = std::min(due_ns, free_ns_);
  }
  return due_ns;
}

std::vector<LineOrder> BaseDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<BaseOdometry> BaseDriver::take_odometry() {
  return std::exchange(odometry_, {});
}

void BaseDriver::pump(std::int64_t now_ns) {
  more_to_say_ = false;
  if (phase_ == Phase::kClosed || now_ns < free_ns_) {
    more_to_say_ = true;
    return;
  }
  if (phase_ == Phase::kRunning) {
    if (const auto halt = script_.empty() ? motion_.next_halt() : std::nullopt) {
      return write(*halt, now_ns);
    }
  }
  if (!script_.empty()) {
    Write next = std::move(script_.front());
    script_.pop_front();
    return write(std::move(next), now_ns);
  }
  if (phase_ != Phase::kRunning) return;
  if (const auto order = next_order(now_ns)) write(*order, now_ns);
}

std::optional<McpOrder> BaseDriver::next_order(std::int64_t now_ns) {
  if (now_ns >= refresh_ns_) {
    refresh_ns_ = now_ns + nanoseconds(settings_.watchdog_s) / 3;
    repeat_settings_ = true;
    return watchdog_order(settings_);
  }
  if (const auto order = motion_.next()) {
    if (primitive_ && !primitive_->told_ns && motion_.relative_told()) primitive_->told_ns = now_ns;
    return order;
  }
  if (std::exchange(acknowledge_, false)) return McpOrder{McpCommand::kAcknowledge, 0};
  if (std::exchange(repeat_settings_, false)) {
    const std::vector<McpOrder> orders = silent_orders(settings_);
    const std::size_t index = repeated_++ % (orders.size() + 2);
    return index < orders.size() ? orders[index] : motion_.repeat_acceleration();
  }
  if (now_ns >= battery_ns_) {
    battery_ns_ = now_ns + nanoseconds(settings_.battery_period_s);
    return McpOrder{McpCommand::kBatteryVoltage};
  }
  return std::nullopt;
}

void BaseDriver::write(const McpOrder& order, std::int64_t now_ns) {
  Write write_order{{}, nanoseconds(settings_.write_gap_s)};
  if (settings_.dialect == BaseDialect::kBinary) {
    const McpPacket packet = binary_packet(order);
    write_order.order.bytes.assign(packet.begin(), packet.end());
  } else {
    append_ascii(order, write_order.order.bytes);
  }
  write(std::move(write_order), now_ns);
}

void BaseDriver::write(Write next, std::int64_t now_ns) {
  const std::int64_t line_ns = line_time_ns(next.order.bytes.size(), settings_.line);
  free_ns_ = std::max(free_ns_, now_ns) + std::max(line_ns, next.pause_ns);
  orders_.push_back(std::move(next.order));
  more_to_say_ = true;
}

}  // namespace topogeo::devices
