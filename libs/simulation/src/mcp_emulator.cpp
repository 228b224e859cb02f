#include "topogeo/simulation/mcp_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::simulation {
namespace {

using devices::McpCommand;
using devices::McpField;

// After power-on, by MIRO's base driver, which quotes the B21 User's Guide of RWI.
constexpr std::uint32_t kTranslateVelocity = 0x0800;
constexpr std::uint32_t kTranslateAcceleration = 0x4000;
constexpr std::uint32_t kRotateVelocity = 0x0080;
constexpr std::uint32_t kRotateAcceleration = 0x0400;

constexpr double kOrigin = 0x8000;
constexpr double kLowBatteryVolts = 44.0;
/// While motors turn, ticks are due so often that speeds are smooth.
constexpr std::int64_t kMotorStep_ns = 10'000'000;
/// A report that is cut keeps so many bytes, or a quarter of a short one, and loses three times as
/// many.
constexpr std::size_t kLeastCut = 4;
/// A report that would wait longer than this for the line is left out.
constexpr std::int64_t kBacklog_ns = 50'000'000;

std::uint32_t wrapped(double value) {
  return static_cast<std::uint32_t>(std::llround(value) & 0xFFFF);
}

std::uint32_t magnitude(double speed) {
  return static_cast<std::uint32_t>(std::min(std::round(std::abs(speed)), 65535.0));
}

}  // namespace

McpEmulator::McpEmulator(const McpEmulatorSettings& settings, std::int64_t now_ns)
    : settings_(settings),
      units_(settings.calibration),
      random_(settings.seed),
      battery_v_(settings.battery_v),
      translation_(kTranslateVelocity, kTranslateAcceleration),
      rotation_(kRotateVelocity, kRotateAcceleration) {
  switch_on(now_ns);
}

void McpEmulator::switch_off(std::int64_t now_ns) {
  tick(now_ns);
  output_.clear();
  on_ = false;
  ready_ = false;
  binary_ = false;
  synchronised_ = false;
  echo_ = settings_.echo_at_start;
  line_.clear();
  packet_.clear();
  zeros_ = 0;
  mask_ = 0;
  period_ns_ = 0;
  report_ns_ = watchdog_ns_ = kNever;
  joystick_off_ = false;
  stop_on_bump_ = true;
  translation_ = McpAxis(kTranslateVelocity, kTranslateAcceleration);
  rotation_ = McpAxis(kRotateVelocity, kRotateAcceleration);
  T_base_robot_ = {};
  heading_rad_ = 0.0;
}

void McpEmulator::switch_on(std::int64_t now_ns) {
  switch_off(now_ns);
  on_ = true;
  ready_ = settings_.start_up_ns == 0;
  on_ns_ = now_ns;
}

void McpEmulator::receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
                          std::int64_t now_ns) {
  tick(now_ns);
  if (!ready_ || host != settings_.line) return;
  for (const std::uint8_t byte : bytes) {
    if (binary_) {
      hear_binary(byte, now_ns);
    } else {
      hear_ascii(byte, now_ns);
    }
  }
}

void McpEmulator::tick(std::int64_t now_ns) {
  if (on_ && !ready_ && now_ns >= on_ns_ + settings_.start_up_ns) ready_ = true;
  if (now_ns >= watchdog_ns_) expire_watchdog(now_ns);
  move_motors(now_ns);
  while (now_ns >= report_ns_) {
    if (output_.free_ns() <= report_ns_ + kBacklog_ns) {
      send_report(McpCommand::kReportMask, mask_, report_ns_);
    }
    report_ns_ += period_ns_;
  }
}

std::int64_t McpEmulator::due_ns() const {
  std::int64_t due_ns = std::min(report_ns_, watchdog_ns_);
  if (on_ && !ready_) due_ns = std::min(due_ns, on_ns_ + settings_.start_up_ns);
  if (translation_.moves() || rotation_.moves()) {
    due_ns = std::min(due_ns, moved_ns_ + kMotorStep_ns);
  }
  return due_ns;
}

std::vector<std::uint8_t> McpEmulator::take_output(const devices::LineSettings& host,
                                                   std::int64_t now_ns) {
  tick(now_ns);
  return output_.take(host, now_ns);
}

void McpEmulator::move_motors(std::int64_t now_ns) {
  const double dt_s = 1e-9 * static_cast<double>(now_ns - moved_ns_);
  moved_ns_ = now_ns;
  translation_.advance(dt_s, power_);
  rotation_.advance(dt_s, power_);
}

Velocity McpEmulator::commanded_velocity() const {
  return {units_.metres(1) * translation_.speed(), units_.radians(1) * rotation_.speed()};
}

void McpEmulator::moved(double forward_m, double turn_rad, double time_s) {
  translation_.moved(forward_m / units_.metres(1), time_s);
  rotation_.moved(turn_rad / units_.radians(1), time_s);
  const geometry::Pose2 half_turn{0.0, 0.0, 0.5 * turn_rad};
  const geometry::Pose2 step = half_turn * geometry::Pose2{forward_m, 0.0, 0.0} * half_turn;
  T_base_robot_ = T_base_robot_ * step;
  heading_rad_ += turn_rad;
  T_start_robot_ = T_start_robot_ * step;
}

void McpEmulator::press_bumpers(std::uint16_t pressed, std::int64_t now_ns) {
  const bool more = (pressed & ~bumpers_) != 0;
  const bool changed = pressed != bumpers_;
  bumpers_ = pressed;
  if (!changed || !ready_) return;
  if (more && stop_on_bump_) {
    translation_.halt();
    rotation_.halt();
  }
  if (!binary_) send_line(fmt::format("%BS {:04x}", 0xFFFFU & ~unsigned{bumpers_}), now_ns);
}

void McpEmulator::take_joystick(const Velocity& velocity) {
  if (!ready_ || joystick_off_) return;
  translation_.follow(velocity.linear_m_per_s / units_.metres(1));
  rotation_.follow(velocity.angular_rad_per_s / units_.radians(1));
}

void McpEmulator::set_battery(double battery_v, std::int64_t now_ns) {
  const bool sank = battery_v < kLowBatteryVolts && battery_v_ >= kLowBatteryVolts;
  battery_v_ = battery_v;
  if (sank) say("%BLO", {0x01, 0x20}, now_ns);
}

void McpEmulator::fail_motor(std::int64_t now_ns) {
  translation_.limp();
  say("%TERR", {0x01, 0x01}, now_ns);
}

void McpEmulator::expire_watchdog(std::int64_t now_ns) {
  watchdog_ns_ = kNever;
  if (settings_.watchdog_limps) {
    translation_.limp();
    rotation_.limp();
  } else {
    translation_.halt();
    rotation_.halt();
  }
  say("%WDT motors stopped", {0x16}, now_ns);
}

/// What it says unasked, in the dialect that it speaks.
void McpEmulator::say(std::string_view ascii, const std::vector<std::uint8_t>& binary,
                      std::int64_t now_ns) {
  if (!ready_) return;
  if (!binary_) return send_line(std::string(ascii), now_ns);
  std::vector<std::uint8_t> frame;
  devices::append_binary_frame(binary, frame);
  send(std::move(frame), now_ns);
}

void McpEmulator::send_line(std::string line, std::int64_t now_ns) {
  line += settings_.form.line_end;
  send({line.begin(), line.end()}, now_ns);
}

void McpEmulator::send(std::vector<std::uint8_t> bytes, std::int64_t now_ns) {
  if (on_ && !silent_) output_.send(std::move(bytes), settings_.line, now_ns);
}

void McpEmulator::send_garbage(std::size_t bytes, std::int64_t now_ns) {
  std::vector<std::uint8_t> garbage(bytes);
  for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random_.below(256));
  send(std::move(garbage), now_ns);
}

std::uint32_t McpEmulator::clock(std::int64_t now_ns) const {
  const double ticks = 1e-9 * static_cast<double>(now_ns - on_ns_) *
                       static_cast<double>(devices::kMcpTicksPerSecond) *
                       (1.0 + 1e-6 * settings_.clock_drift_ppm);
  return settings_.clock_at_start + static_cast<std::uint32_t>(static_cast<std::uint64_t>(ticks));
}

devices::McpReport McpEmulator::report(std::uint32_t mask, std::int64_t now_ns) const {
  devices::McpReport report{.mask = mask};
  const auto set = [&report](McpField field, std::uint32_t value) {
    if (report.has(field)) report.fields[static_cast<std::size_t>(field)] = value;
  };
  set(McpField::kMask, mask);
  set(McpField::kClock, clock(now_ns));
  set(McpField::kBumpers, 0xFFFFU & ~unsigned{bumpers_});
  set(McpField::kX,
      wrapped(kOrigin - units_.clockwise_sign() * units_.position_units(T_base_robot_.y_m)));
  set(McpField::kY, wrapped(kOrigin + units_.position_units(T_base_robot_.x_m)));
  set(McpField::kHeading, wrapped(heading_rad_ / units_.radians(1)));
  set(McpField::kTranslateSpeed, magnitude(translation_.measured()));
  set(McpField::kTranslateStatus, translation_.status());
  set(McpField::kRotateSpeed, magnitude(rotation_.measured()));
  set(McpField::kRotateStatus, rotation_.status());
  return report;
}

void McpEmulator::send_report(McpCommand kind, std::uint32_t mask, std::int64_t now_ns) {
  std::vector<std::uint8_t> bytes;
  if (binary_) {
    devices::append_binary_frame(devices::binary_payload(report(mask, now_ns), kind), bytes);
  } else {
    devices::append_ascii(report(mask, now_ns), settings_.form, bytes);
  }
  damage(bytes);
  ++reports_;
  send(std::move(bytes), now_ns);
}

void McpEmulator::damage(std::vector<std::uint8_t>& report) {
  if (corrupt_ > 0) {
    --corrupt_;
    report[random_.below(report.size())] ^= static_cast<std::uint8_t>(1U << random_.below(8));
  }
  if (truncate_ > 0) {
    --truncate_;
    const std::size_t least = std::min(kLeastCut, report.size() / 4);
    report.resize(least + random_.below(std::max<std::size_t>(report.size() - 4 * least, 1)));
  }
}

}  // namespace topogeo::simulation
