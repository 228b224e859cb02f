#include "topogeo/devices/text_base_driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "topogeo/devices/base_limits.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kTextMs_ns = 1'000'000;
constexpr std::int64_t kAskAgain_ns = 500 * kTextMs_ns;
/// Speeds are sent this often for each time that the base holds them.
constexpr std::int64_t kRefreshes = 5;
/// A report of a base that works follows the last one within this time.
constexpr std::uint32_t kLongestGap_ms = 1000;
/// A wheel turns faster than it may by this share at most, plus what a push adds.
constexpr double kFaster = 3.0;
constexpr double kPush_m = 0.1;
constexpr unsigned kReportsStanding = 2;
constexpr std::uint16_t kNoBumper = 0xFFFF;
constexpr std::uint16_t kFirstBumper = 0xFFFE;

BaseSettings checked_text_base(const BaseSettings& settings) {
  check(settings);
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    if (holds) return;
    throw std::invalid_argument(std::string("base setting ") + name + " is " +
                                std::to_string(value) + ", expected " + expected);
  };
  const TextBaseSettings& text = settings.text;
  require(text.ticks_per_m >= 1.0 && text.ticks_per_m <= 1e7, "ticks_per_m", text.ticks_per_m,
          "1 to 10000000");
  require(text.track_m >= 0.01 && text.track_m <= 10.0, "track_m", text.track_m, "0.01 to 10");
  return settings;
}

std::int64_t text_ns(double seconds) {
  return std::llround(seconds * 1e9);
}

/// Moves towards the wanted value by at most `step`.
double approached(double from, double to, double step) {
  return from + std::clamp(to - from, -step, step);
}

}  // namespace

TextBaseDriver::TextBaseDriver(const BaseSettings& settings)
    : settings_(checked_text_base(settings)),
      limits_(settings.limits),
      interlocks_(settings),
      term_(settings) {
  update_status();
}

void TextBaseDriver::opened(std::int64_t now_ns) {
  orders_ = {{settings_.line, {}, {}}};
  reader_.clear();
  disconnect("no answer yet");
  asked_ns_ = now_ns - kAskAgain_ns;
  tick(now_ns);
}

void TextBaseDriver::lost(std::int64_t /*now_ns*/) {
  disconnect("the port is closed");
  link_ = Link::kClosed;
  orders_.clear();
  update_status();
}

void TextBaseDriver::disconnect(const std::string& reason) {
  link_ = Link::kAsking;
  reason_ = reason;
  heard_ = false;
  doubted_.reset();
  term_.clear();
  wanted_ = sent_ = {};
  at_rest_ = 0;
  interlocks_.offline();
}

void TextBaseDriver::write(const std::string& line) {
  orders_.push_back({std::nullopt, {line.begin(), line.end()}, {}});
}

void TextBaseDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (link_ == Link::kClosed) return;
  for (const std::string& body : reader_.read(bytes)) {
    if (const auto message = text_base_message(body)) {
      take(*message, now_ns);
    } else {
      ++bad_fields_;
    }
  }
  tick(now_ns);
}

void TextBaseDriver::take(const TextBaseMessage& message, std::int64_t now_ns) {
  if (message.hello) {
    if (message.hello->version != kTextBaseVersion) {
      disconnect("the base speaks version " + std::to_string(message.hello->version) +
                 " of the line protocol: expected " + std::to_string(kTextBaseVersion));
      return;
    }
    disconnect({});
    ++status_.starts;
    link_ = Link::kRunning;
    last_arrival_ns_ = now_ns;
    sent_ns_ = now_ns - text_ns(settings_.watchdog_s);
  }
  if (message.battery && link_ == Link::kRunning) {
    status_.battery_v = 1e-3 * message.battery->millivolts;
    status_.battery_low = status_.battery_v < settings_.battery_low_v;
  }
  if (message.report && link_ == Link::kRunning) take(*message.report, now_ns);
}

bool TextBaseDriver::plausible(const TextBaseReport& report, std::int64_t now_ns) const {
  const std::uint32_t passed_ms = report.time_ms - last_->time_ms;
  const std::int64_t gap_ms = (now_ns - last_report_ns_) / kTextMs_ns;
  if (passed_ms == 0 || passed_ms > kLongestGap_ms + gap_ms) return false;
  const double turn_mps = 0.5 * settings_.text.track_m * settings_.limits.angular_radps;
  const double most_m =
      kPush_m + kFaster * 1e-3 * passed_ms * (settings_.limits.linear_mps + turn_mps);
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const auto moved = static_cast<std::int32_t>(static_cast<std::uint32_t>(report.ticks[wheel]) -
                                                 static_cast<std::uint32_t>(last_->ticks[wheel]));
    if (std::fabs(moved / settings_.text.ticks_per_m) > most_m) return false;
  }
  return true;
}

void TextBaseDriver::take(const TextBaseReport& report, std::int64_t now_ns) {
  if (last_ && !plausible(report, now_ns)) {
    ++implausible_;
    // Two reports that follow each other, but not the ones before, come from a base that restarted.
    const auto before = std::exchange(last_, std::exchange(doubted_, report));
    const bool follows = last_ && plausible(report, now_ns);
    if (!follows) {
      last_ = before;
      return;
    }
    ++status_.restarts;
    clock_.restart();
  }
  doubted_.reset();
  last_arrival_ns_ = last_report_ns_ = now_ns;
  heard_ = true;
  ++status_.reports;
  if (last_) move(report, now_ns);
  last_ = report;
  obey_flags(report, now_ns);
}

void TextBaseDriver::move(const TextBaseReport& report, std::int64_t now_ns) {
  const std::uint32_t passed_ms = report.time_ms - last_->time_ms;
  const double passed_s = 1e-3 * passed_ms;
  std::array<double, 2> wheels_m{};
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const auto moved = static_cast<std::int32_t>(static_cast<std::uint32_t>(report.ticks[wheel]) -
                                                 static_cast<std::uint32_t>(last_->ticks[wheel]));
    wheels_m[wheel] = moved / settings_.text.ticks_per_m;
  }
  const double forward_m = 0.5 * (wheels_m[0] + wheels_m[1]);
  double turn_rad = (wheels_m[1] - wheels_m[0]) / settings_.text.track_m;
  if (settings_.text.gyro && report.turn_mradps) turn_rad = 1e-3 * *report.turn_mradps * passed_s;
  // Half the turn, forward, the other half.
  const geometry::Pose2 half{0.0, 0.0, 0.5 * turn_rad};
  T_odom_robot_ = T_odom_robot_ * half * geometry::Pose2{forward_m, 0.0, 0.0} * half;
  device_ns_ += static_cast<std::int64_t>(passed_ms) * kTextMs_ns;
  const bool rests = wheels_m[0] == 0.0 && wheels_m[1] == 0.0 && sent_ == BaseVelocity{};
  at_rest_ = rests ? at_rest_ + 1 : 0;
  odometry_.push_back(
      {clock_.map(device_ns_, now_ns), T_odom_robot_, forward_m / passed_s, turn_rad / passed_s});
}

void TextBaseDriver::obey_flags(const TextBaseReport& report, std::int64_t now_ns) {
  if (report.emergency_stop && interlocks_.emergency_stop()) stand(now_ns);
  if (report.watchdog && term_.velocity_holds()) {
    ++status_.watchdog_expirations;
    interlocks_.watchdog_expired(now_ns);
    stand(now_ns);
  }
  const std::uint16_t bumpers = report.bumper ? kFirstBumper : kNoBumper;
  if (interlocks_.bumpers(bumpers, sent_.linear_mps, now_ns)) stand(now_ns);
}

void TextBaseDriver::stand(std::int64_t now_ns) {
  term_.clear();
  wanted_ = sent_ = {};
  if (link_ == Link::kRunning) send_speeds(now_ns);
}

/// The base obeys for watchdog_s, so that it stops by itself when this driver does not go on.
void TextBaseDriver::send_speeds(std::int64_t now_ns) {
  const double passed_s = 1e-9 * static_cast<double>(now_ns - sent_ns_);
  sent_ns_ = now_ns;
  BaseVelocity allowed = guard_ && term_.velocity_holds() ? guard_(wanted_, now_ns) : wanted_;
  allowed.linear_mps = std::clamp(allowed.linear_mps, -limits_.linear_mps, limits_.linear_mps);
  allowed.angular_radps =
      std::clamp(allowed.angular_radps, -limits_.angular_radps, limits_.angular_radps);
  const double most_s = std::min(passed_s, settings_.watchdog_s);
  sent_.linear_mps = approached(sent_.linear_mps, allowed.linear_mps, most_s * limits_.linear_mps2);
  sent_.angular_radps =
      approached(sent_.angular_radps, allowed.angular_radps, most_s * limits_.angular_radps2);
  const std::string hold = "," + std::to_string(std::llround(1e3 * settings_.watchdog_s));
  const auto milli = [](double value) { return std::to_string(std::llround(1e3 * value)); };
  if (settings_.text.mixes) {
    return write(
        text_base_line("W," + milli(sent_.linear_mps) + "," + milli(sent_.angular_radps) + hold));
  }
  const double side_mps = 0.5 * settings_.text.track_m * sent_.angular_radps;
  write(text_base_line("V," + milli(sent_.linear_mps - side_mps) + "," +
                       milli(sent_.linear_mps + side_mps) + hold));
}

void TextBaseDriver::tick(std::int64_t now_ns) {
  if (link_ == Link::kClosed) return;
  if (term_.expired(now_ns)) stand(now_ns);
  interlocks_.tick(now_ns);
  if (link_ == Link::kRunning && now_ns >= last_arrival_ns_ + text_ns(settings_.silence_s)) {
    disconnect("no report for " + std::to_string((now_ns - last_arrival_ns_) / kTextMs_ns) + " ms");
    asked_ns_ = now_ns - kAskAgain_ns;
  }
  if (link_ == Link::kAsking && now_ns >= asked_ns_ + kAskAgain_ns) {
    asked_ns_ = now_ns;
    write(text_base_line("?"));
  }
  if (link_ == Link::kRunning && now_ns >= sent_ns_ + text_ns(settings_.watchdog_s) / kRefreshes) {
    send_speeds(now_ns);
  }
  update_status();
}

std::int64_t TextBaseDriver::due_ns() const {
  if (link_ == Link::kClosed) return std::numeric_limits<std::int64_t>::max();
  const std::int64_t due_ns = std::min(term_.due_ns(), interlocks_.due_ns());
  if (link_ == Link::kAsking) return std::min(due_ns, asked_ns_ + kAskAgain_ns);
  return std::min({due_ns, last_arrival_ns_ + text_ns(settings_.silence_s),
                   sent_ns_ + text_ns(settings_.watchdog_s) / kRefreshes});
}

std::vector<LineOrder> TextBaseDriver::take_orders() {
  return std::exchange(orders_, {});
}

bool TextBaseDriver::commands_taken() const {
  return link_ == Link::kRunning && heard_ && !interlocks_.engaged();
}

bool TextBaseDriver::command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
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

void TextBaseDriver::guard_velocities(VelocityGuard guard, std::int64_t /*period_ns*/) {
  guard_ = std::move(guard);  // asked at each refresh, more often than any guard needs
}

void TextBaseDriver::halt(std::int64_t now_ns) {
  interlocks_.halt();
  stand(now_ns);
  if (link_ == Link::kRunning) write(text_base_line("S"));
  tick(now_ns);
}

void TextBaseDriver::end(std::int64_t now_ns) {
  interlocks_.end();
  ended_ = true;
  stand(now_ns);
  if (link_ == Link::kRunning) write(text_base_line("S"));
  tick(now_ns);
}

void TextBaseDriver::reset_stop(std::int64_t now_ns) {
  interlocks_.release();
  stand(now_ns);
  tick(now_ns);
}

void TextBaseDriver::hold_stops(const HeldStops& stops) {
  interlocks_.hold(stops);
  update_status();
}

void TextBaseDriver::set_limits(const BaseLimits& limits, std::int64_t now_ns) {
  limits_ = within(limits, settings_.limits);
  tick(now_ns);
}

std::vector<BaseOdometry> TextBaseDriver::take_odometry() {
  return std::exchange(odometry_, {});
}

void TextBaseDriver::update_status() {
  const bool running = link_ == Link::kRunning && heard_;
  status_.stands = running && at_rest_ >= kReportsStanding;
  status_.bumpers = interlocks_.pressed();
  status_.commands_taken = commands_taken();
  const auto stopped = interlocks_.state();
  if (link_ == Link::kClosed || (link_ == Link::kAsking && !reason_.empty())) {
    status_.state = BaseState::kOffline;
  } else if (!running) {
    status_.state = BaseState::kStarting;
  } else if (stopped) {
    status_.state = *stopped;
  } else {
    status_.state = status_.stands ? BaseState::kReady : BaseState::kMoving;
  }
  status_.reason = !running && !reason_.empty() ? reason_
                   : ended_                     ? "the gateway ends"
                                                : std::string(base_state_reason(status_.state));
  count_of(status_.drops, McpDrop::kChecksum) = reader_.counters().bad_checksum;
  count_of(status_.drops, McpDrop::kLongLine) = reader_.counters().long_lines;
  count_of(status_.drops, McpDrop::kGarbage) = reader_.counters().noise_bytes;
  count_of(status_.drops, McpDrop::kBadReport) = bad_fields_;
  count_of(status_.drops, McpDrop::kImplausible) = implausible_;
}

}  // namespace topogeo::devices
