// What an emulated base makes of what it hears.
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/simulation/mcp_emulator.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::simulation {
namespace {

using devices::McpCommand;
using devices::McpOrder;

constexpr std::size_t kLongestLine = 80;
constexpr std::size_t kMostHeard = 100'000;
/// Within packets four zeros follow one another at most: an argument of 0.
constexpr unsigned kSyncZeros = 6;
constexpr std::uint32_t kRotateOrigin = 0x80000000U;

std::int64_t ticks_ns(std::uint32_t ticks) {
  return devices::ticks_ns(std::int64_t{ticks});
}

std::optional<McpOrder> parsed(std::string_view line) {
  const auto command = devices::command_of(line.substr(0, 2));
  if (!command) return std::nullopt;
  std::string_view rest = line.substr(2);
  const std::size_t digit = rest.find_first_not_of(' ');
  rest = digit == std::string_view::npos ? std::string_view{} : rest.substr(digit);
  McpOrder order{*command};
  const auto largest = devices::largest_argument(*command);
  if (rest.empty() != !largest) return std::nullopt;
  if (!largest) return order;
  const char* const end = rest.data() + rest.size();
  const auto [last, error] = std::from_chars(rest.data(), end, order.argument, 16);
  if (error != std::errc() || last != end || order.argument > *largest) return std::nullopt;
  return order;
}

}  // namespace

void McpEmulator::hear_ascii(std::uint8_t byte, std::int64_t now_ns) {
  if (byte != '\r') {
    if (echo_) send({byte}, now_ns);
    if (line_.size() < kLongestLine) line_.push_back(static_cast<char>(byte));
    return;
  }
  if (echo_) send_line({}, now_ns);
  hear_line(now_ns);
}

void McpEmulator::hear_line(std::int64_t now_ns) {
  const std::string line = std::exchange(line_, {});
  if (const auto order = parsed(line)) execute(*order, now_ns);
}

/// After a packet that is wrong everything up to six zeros is passed over; more of them may follow.
void McpEmulator::hear_binary(std::uint8_t byte, std::int64_t now_ns) {
  zeros_ = byte == 0 ? zeros_ + 1 : 0;
  if (zeros_ >= kSyncZeros) {
    synchronised_ = true;
    packet_.clear();
    return;
  }
  if (!synchronised_) return;
  packet_.push_back(byte);
  if (packet_.size() < std::tuple_size_v<devices::McpPacket>) return;
  std::uint32_t argument = 0;
  for (std::size_t i = 1; i < 5; ++i) argument = argument << 8U | packet_[i];
  const McpOrder order{static_cast<McpCommand>(packet_[0]), argument};
  const devices::McpPacket right = devices::binary_packet(order);
  const bool good = packet_.back() == right.back();
  packet_.clear();
  if (good) return execute(order, now_ns);
  synchronised_ = false;
  say({}, {0x00}, now_ns);
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
  say(text, payload, now_ns);
}

void McpEmulator::execute(const McpOrder& order, std::int64_t now_ns) {
  heard_.push_back(order);
  if (heard_.size() > kMostHeard) heard_.erase(heard_.begin(), heard_.begin() + kMostHeard / 2);
  if (execute_motion(order)) return;
  switch (order.command) {
    case McpCommand::kDirectMode:
      binary_ = !binary_;
      synchronised_ = false;
      zeros_ = 0;
      packet_.clear();
      break;
    case McpCommand::kAcknowledge:
      say("%TCLR", {0x02}, now_ns);
      break;
    case McpCommand::kHalfDuplex:
      echo_ = echo_ && !settings_.echo_can_be_switched_off;
      break;
    case McpCommand::kFullDuplex:
      echo_ = true;
      break;
    case McpCommand::kJoystickOff:
      joystick_off_ = order.argument != 0;
      break;
    case McpCommand::kReportOnce:
      send_report(McpCommand::kReportOnce, order.argument, now_ns);
      break;
    case McpCommand::kReportMask:
      mask_ = order.argument;
      break;
    case McpCommand::kReportPeriod:
      period_ns_ = ticks_ns(order.argument);
      report_ns_ = period_ns_ == 0 ? kNever : now_ns + period_ns_;
      break;
    case McpCommand::kWatchdog:
      watchdog_ns_ = order.argument == 0 ? kNever : now_ns + ticks_ns(order.argument);
      break;
    case McpCommand::kBumpStop:
      stop_on_bump_ = order.argument == 0;
      break;
    case McpCommand::kTranslateWhere:
      answer(order.command, static_cast<std::uint32_t>(std::llround(translation_.position())),
             now_ns);
      break;
    case McpCommand::kRotateWhere:
      answer(order.command,
             kRotateOrigin + static_cast<std::uint32_t>(std::llround(rotation_.position())),
             now_ns);
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

/// False if the command is none of motion.
bool McpEmulator::execute_motion(const McpOrder& order) {
  const double counts = order.argument;
  switch (order.command) {
    case McpCommand::kKill:
    case McpCommand::kShutdown:
      translation_.limp();
      rotation_.limp();
      break;
    case McpCommand::kTranslateVelocity:
      translation_.set_velocity(order.argument);
      break;
    case McpCommand::kTranslateAcceleration:
      translation_.set_acceleration(order.argument);
      break;
    case McpCommand::kTranslateHalt:
      translation_.halt();
      break;
    case McpCommand::kTranslateLimp:
      translation_.limp();
      break;
    case McpCommand::kTranslateForward:
      translation_.go(counts);
      break;
    case McpCommand::kTranslateBackward:
      translation_.go(-counts);
      break;
    case McpCommand::kTranslatePlus:
      translation_.run(1);
      break;
    case McpCommand::kTranslateMinus:
      translation_.run(-1);
      break;
    case McpCommand::kTranslateTo:
      translation_.go(static_cast<std::int32_t>(order.argument) - translation_.position());
      break;
    case McpCommand::kRotateVelocity:
      rotation_.set_velocity(order.argument);
      break;
    case McpCommand::kRotateAcceleration:
      rotation_.set_acceleration(order.argument);
      break;
    case McpCommand::kRotateHalt:
      rotation_.halt();
      break;
    case McpCommand::kRotateLimp:
      rotation_.limp();
      break;
    case McpCommand::kRotatePositive:
      rotation_.go(counts);
      break;
    case McpCommand::kRotateNegative:
      rotation_.go(-counts);
      break;
    case McpCommand::kRotatePlus:
      rotation_.run(1);
      break;
    case McpCommand::kRotateMinus:
      rotation_.run(-1);
      break;
    case McpCommand::kRotateTo:
      rotation_.go(static_cast<std::int32_t>(order.argument - kRotateOrigin) -
                   rotation_.position());
      break;
    default:
      return false;
  }
  return true;
}

}  // namespace topogeo::simulation
