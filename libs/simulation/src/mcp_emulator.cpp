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
using devices::McpOrder;

/// The base warns below it; from the same guide as the values of McpDrive.
constexpr double kLowBatteryVolts = 44.0;
/// Interval of ticks while motors turn, short enough for smooth speeds.
constexpr std::int64_t kMotorStep_ns = 10'000'000;
/// Drops a report that would wait longer than this for the line.
constexpr std::int64_t kBacklog_ns = 50'000'000;
/// Orders kept for tests: more than any test sends, few enough for a simulator that runs for days.
constexpr std::size_t kMostOrders = 100'000;

std::int64_t ticks_ns(std::uint32_t ticks) {
  return devices::ticks_ns(std::int64_t{ticks});
}

}  // namespace

McpEmulator::McpEmulator(const McpEmulatorSettings& settings, std::int64_t now_ns)
    : settings_(settings),
      drive_(settings.calibration),
      faults_(settings.seed),
      battery_v_(settings.battery_v) {
  switch_on(now_ns);
}

void McpEmulator::switch_off(std::int64_t now_ns) {
  tick(now_ns);
  output_.clear();
  on_ = false;
  ready_ = false;
  reader_ = {};
  drive_.reset();
  echo_ = settings_.echo_at_start;
  reporting_ = {};
  watchdog_ns_ = kNever;
  joystick_off_ = false;
  stop_on_bump_ = true;
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
    echo(byte, now_ns);
    const McpOrderReader::Reading reading = reader_.read(byte);
    if (reading.order) execute(*reading.order, now_ns);
    if (reading.damaged) send({}, {0x00}, now_ns);
  }
}

void McpEmulator::echo(std::uint8_t byte, std::int64_t now_ns) {
  if (!echo_ || reader_.binary()) return;
  if (byte == '\r') return send_line({}, now_ns);
  send_bytes({byte}, now_ns);
}

void McpEmulator::tick(std::int64_t now_ns) {
  if (on_ && !ready_ && now_ns >= on_ns_ + settings_.start_up_ns) ready_ = true;
  if (now_ns >= watchdog_ns_) expire_watchdog(now_ns);
  drive_.advance(now_ns);
  while (now_ns >= reporting_.due_ns) {
    if (output_.free_ns() <= reporting_.due_ns + kBacklog_ns) {
      send_report(McpCommand::kReportMask, reporting_.mask, reporting_.due_ns);
    }
    reporting_.due_ns += reporting_.period_ns;
  }
}

void McpEmulator::stand_still(std::int64_t duration_ns) {
  if (watchdog_ns_ != kNever) watchdog_ns_ += duration_ns;
  if (reporting_.due_ns != kNever) reporting_.due_ns += duration_ns;
  drive_.stand_still(duration_ns);
}

std::int64_t McpEmulator::due_ns() const {
  std::int64_t due_ns = std::min(reporting_.due_ns, watchdog_ns_);
  if (on_ && !ready_) due_ns = std::min(due_ns, on_ns_ + settings_.start_up_ns);
  if (drive_.moves()) due_ns = std::min(due_ns, drive_.advanced_ns() + kMotorStep_ns);
  return due_ns;
}

std::vector<std::uint8_t> McpEmulator::take_output(const devices::LineSettings& host,
                                                   std::int64_t now_ns) {
  tick(now_ns);
  return output_.take(host, now_ns);
}

void McpEmulator::press_bumpers(std::uint16_t pressed, std::int64_t now_ns) {
  const bool more = (pressed & ~bumpers_) != 0;
  const bool changed = pressed != bumpers_;
  bumpers_ = pressed;
  if (!changed || !ready_) return;
  if (more && stop_on_bump_) drive_.halt();
  if (!reader_.binary())
    send_line(fmt::format("%BS {:04x}", 0xFFFFU & ~unsigned{bumpers_}), now_ns);
}

void McpEmulator::take_joystick(const geometry::Velocity& velocity) {
  if (ready_ && !joystick_off_) drive_.follow(velocity);
}

void McpEmulator::set_battery(double battery_v, std::int64_t now_ns) {
  const bool sank = battery_v < kLowBatteryVolts && battery_v_ >= kLowBatteryVolts;
  battery_v_ = battery_v;
  if (sank) send("%BLO", {0x01, 0x20}, now_ns);
}

void McpEmulator::fail_motor(std::int64_t now_ns) {
  drive_.fail();
  send("%TERR", {0x01, 0x01}, now_ns);
}

void McpEmulator::expire_watchdog(std::int64_t now_ns) {
  watchdog_ns_ = kNever;
  if (settings_.watchdog_limps) {
    drive_.limp();
  } else {
    drive_.halt();
  }
  send("%WDT motors stopped", {0x16}, now_ns);
}

void McpEmulator::send(std::string_view ascii, const std::vector<std::uint8_t>& binary,
                       std::int64_t now_ns) {
  if (!ready_) return;
  if (!reader_.binary()) return send_line(std::string(ascii), now_ns);
  std::vector<std::uint8_t> frame;
  devices::append_binary_frame(binary, frame);
  send_bytes(std::move(frame), now_ns);
}

void McpEmulator::send_line(std::string line, std::int64_t now_ns) {
  line += settings_.form.line_end;
  send_bytes({line.begin(), line.end()}, now_ns);
}

void McpEmulator::send_bytes(std::vector<std::uint8_t> bytes, std::int64_t now_ns) {
  if (on_ && !faults_.silent()) output_.send(std::move(bytes), settings_.line, now_ns);
}

void McpEmulator::send_garbage(std::size_t bytes, std::int64_t now_ns) {
  send_bytes(faults_.garbage(bytes), now_ns);
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
  drive_.fill(report);
  return report;
}

void McpEmulator::send_report(McpCommand kind, std::uint32_t mask, std::int64_t now_ns) {
  std::vector<std::uint8_t> bytes;
  if (reader_.binary()) {
    devices::append_binary_frame(devices::binary_payload(report(mask, now_ns), kind), bytes);
  } else {
    devices::append_ascii(report(mask, now_ns), settings_.form, bytes);
  }
  faults_.damage(bytes);
  ++reports_;
  send_bytes(std::move(bytes), now_ns);
}

void McpEmulator::answer(McpCommand command, std::uint32_t value, std::int64_t now_ns) {
  const std::string text =
      fmt::format("{}{} {:x}", settings_.prompt ? "*" : "", devices::mnemonic(command), value);
  std::vector<std::uint8_t> payload{static_cast<std::uint8_t>(command)};
  const bool narrow =
      command == McpCommand::kBatteryVoltage || command == McpCommand::kBatteryCurrent;
  for (unsigned shift = narrow ? 16 : 32; shift > 0; shift -= 8) {
    payload.push_back(static_cast<std::uint8_t>(value >> (shift - 8) & 0xFFU));
  }
  send(text, payload, now_ns);
}

void McpEmulator::execute(const McpOrder& order, std::int64_t now_ns) {
  orders_.push_back(order);
  if (orders_.size() > kMostOrders) {
    orders_.erase(orders_.begin(), orders_.begin() + kMostOrders / 2);
  }
  if (!drive_.execute(order) && !execute_setting(order, now_ns)) execute_question(order, now_ns);
}

/// False if the order is no setting.
bool McpEmulator::execute_setting(const McpOrder& order, std::int64_t now_ns) {
  switch (order.command) {
    case McpCommand::kDirectMode:
      reader_.switch_dialect();
      return true;
    case McpCommand::kHalfDuplex:
      echo_ = echo_ && !settings_.echo_can_be_switched_off;
      return true;
    case McpCommand::kFullDuplex:
      echo_ = true;
      return true;
    case McpCommand::kJoystickOff:
      joystick_off_ = order.argument != 0;
      return true;
    case McpCommand::kReportMask:
      reporting_.mask = order.argument;
      return true;
    case McpCommand::kReportPeriod:
      reporting_.period_ns = ticks_ns(order.argument);
      reporting_.due_ns = reporting_.period_ns == 0 ? kNever : now_ns + reporting_.period_ns;
      return true;
    case McpCommand::kWatchdog:
      watchdog_ns_ = order.argument == 0 ? kNever : now_ns + ticks_ns(order.argument);
      return true;
    case McpCommand::kBumpStop:
      stop_on_bump_ = order.argument == 0;
      return true;
    default:
      return false;
  }
}

void McpEmulator::execute_question(const McpOrder& order, std::int64_t now_ns) {
  switch (order.command) {
    case McpCommand::kAcknowledge:
      send("%TCLR", {0x02}, now_ns);
      break;
    case McpCommand::kReportOnce:
      send_report(McpCommand::kReportOnce, order.argument, now_ns);
      break;
    case McpCommand::kTranslateWhere:
      answer(order.command, drive_.translate_register(), now_ns);
      break;
    case McpCommand::kRotateWhere:
      answer(order.command, drive_.rotate_register(), now_ns);
      break;
    case McpCommand::kBatteryVoltage:
      answer(order.command, static_cast<std::uint32_t>(std::llround(10.0 * battery_v_)), now_ns);
      break;
    case McpCommand::kClock:
      answer(order.command, clock(now_ns), now_ns);
      break;
    default:
      break;
  }
}

void McpEmulator::set_fault(BaseFault fault, bool on) {
  constexpr int kEveryMessage = 1'000'000'000;
  switch (fault) {
    case BaseFault::kCorrupted:
      return faults_.corrupt(on ? kEveryMessage : 0);
    case BaseFault::kTruncated:
      return faults_.truncate(on ? kEveryMessage : 0);
    case BaseFault::kSilent:
      return faults_.set_silent(on);
    case BaseFault::kEcho:
      return set_echo(on);
  }
}

}  // namespace topogeo::simulation
