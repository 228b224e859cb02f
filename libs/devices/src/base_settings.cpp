#include "topogeo/devices/base_settings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/mcp_ascii.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint32_t kNeededFields =
    mask_bit(McpField::kClock) | mask_bit(McpField::kX) | mask_bit(McpField::kY) |
    mask_bit(McpField::kHeading) | mask_bit(McpField::kTranslateSpeed) |
    mask_bit(McpField::kTranslateStatus) | mask_bit(McpField::kRotateSpeed) |
    mask_bit(McpField::kRotateStatus);
/// A tenth of a second: more frequent reports leave no room for commands at 9600 baud.
constexpr double kLeastPeriodTicks = 26.0;
/// Multiple of the line's time, so that answers and echoes find room between the reports.
constexpr double kRoom = 1.2;

void in_range(const char* name, double value, double above, double largest) {
  if (value > above && value <= largest) return;
  throw std::invalid_argument("base settings: " + std::string(name) + " is " +
                              std::to_string(value) + ", not in (" + std::to_string(above) + ", " +
                              std::to_string(largest) + "]");
}

}  // namespace

void check(const BaseSettings& settings) {
  (void)McpUnits(settings.calibration);
  constexpr double kLargest = std::numeric_limits<double>::max();
  in_range("line.baud", settings.line.baud, 0, 1e6);
  in_range("limits.linear_mps", settings.limits.linear_mps, 0, kLargest);
  in_range("limits.angular_radps", settings.limits.angular_radps, 0, kLargest);
  in_range("limits.linear_mps2", settings.limits.linear_mps2, 0, kLargest);
  in_range("limits.angular_radps2", settings.limits.angular_radps2, 0, kLargest);
  in_range("watchdog_s", settings.watchdog_s, 0, 255);
  in_range("command_timeout_s", settings.command_timeout_s, 0, 0.5);
  in_range("silence_s", settings.silence_s, 0, 3600);
  in_range("write_gap_s", settings.write_gap_s, -1e-9, 1);
  in_range("direct_mode_wait_s", settings.direct_mode_wait_s, 0, 60);
  in_range("report_period_s", settings.report_period_s, -1e-9, 255);
  in_range("stalled_reports", settings.stalled_reports, 1, 1000);
  in_range("ripple_mps", settings.ripple_mps, 0, kLargest);
  in_range("ripple_radps", settings.ripple_radps, 0, kLargest);
  in_range("ramp_mps", settings.ramp_mps, 0, kLargest);
  in_range("ramp_radps", settings.ramp_radps, 0, kLargest);
  in_range("battery_period_s", settings.battery_period_s, 0, kLargest);
  in_range("pioneer.units_per_m", settings.pioneer.units_per_m, 0, 1e6);
  in_range("pioneer.units_per_turn", settings.pioneer.units_per_turn, 0, 1e6);
  in_range("pioneer.sonar_units_per_m", settings.pioneer.sonar_units_per_m, 0, 1e6);
  in_range("roboteq.motor_turns_per_m", settings.roboteq.motor_turns_per_m, 0, 1e6);
  in_range("roboteq.full_rpm", settings.roboteq.full_rpm, -1e-9, 1e5);
  in_range("roboteq.left_channel", settings.roboteq.left_channel, 0, 2);
  in_range("vesc.pole_pairs", settings.vesc.pole_pairs, 0, 1000);
  in_range("vesc.motor_turns_per_m", settings.vesc.motor_turns_per_m, 0, 1e4);
  in_range("vesc.can_id", settings.vesc.can_id, -1, 253);
  if ((settings.report_mask & kNeededFields) != kNeededFields) {
    throw std::invalid_argument("base settings: report_mask is " +
                                std::to_string(settings.report_mask) + ", expected all bits of " +
                                std::to_string(kNeededFields));
  }
}

std::int64_t report_line_time_ns(const BaseSettings& settings) {
  std::vector<std::uint8_t> bytes;
  const McpReport report{.mask = settings.report_mask};
  if (settings.dialect == BaseDialect::kAscii) {
    append_ascii(report, {}, bytes);
  } else {
    append_binary_frame(binary_payload(report, McpCommand::kReportMask), bytes);
  }
  return line_time_ns(bytes.size(), settings.line);
}

std::uint16_t report_period_ticks(const BaseSettings& settings) {
  const double period_s = settings.report_period_s > 0
                              ? settings.report_period_s
                              : kRoom * 1e-9 * static_cast<double>(report_line_time_ns(settings));
  const double least = settings.report_period_s > 0 ? 1.0 : kLeastPeriodTicks;
  const double ticks = std::ceil(period_s * static_cast<double>(kMcpTicksPerSecond) - 1e-9);
  return static_cast<std::uint16_t>(std::clamp(ticks, least, 65535.0));
}

}  // namespace topogeo::devices
