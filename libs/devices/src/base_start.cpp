#include "topogeo/devices/base_start.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::devices {

McpOrder watchdog_order(const BaseSettings& settings) {
  // Never longer than the guards assume.
  const double ticks = std::floor(settings.watchdog_s * static_cast<double>(kMcpTicksPerSecond));
  return {McpCommand::kWatchdog, static_cast<std::uint32_t>(std::max(1.0, ticks))};
}

std::vector<McpOrder> silent_orders(const BaseSettings& settings) {
  std::vector<McpOrder> orders{
      {McpCommand::kJoystickOff, settings.joystick_allowed ? 0U : 1U},
      {McpCommand::kErrorDelay, settings.error_delay_ticks},
      {McpCommand::kBumpStop, settings.stop_on_bump ? 0U : 0xFFFFU},
  };
  if (settings.torque) orders.push_back({McpCommand::kTranslateTorque, *settings.torque});
  if (settings.dialect == BaseDialect::kAscii) orders.push_back({McpCommand::kHalfDuplex});
  return orders;
}

std::vector<McpOrder> set_up_orders(const BaseSettings& settings) {
  std::vector<McpOrder> orders{{McpCommand::kJoystickOff, 1}};
  std::uint32_t mask = settings.report_mask;
  if (settings.dialect == BaseDialect::kAscii) {
    orders.push_back({McpCommand::kHalfDuplex});
  } else {
    orders.push_back({McpCommand::kIndexMask, 0xFF});
    mask |= mask_bit(McpField::kMask);
  }
  orders.push_back({McpCommand::kTranslateHalt});
  orders.push_back({McpCommand::kRotateHalt});
  for (const McpOrder& order : silent_orders(settings)) {
    if (order.command != McpCommand::kHalfDuplex) orders.push_back(order);
  }
  orders.push_back(watchdog_order(settings));
  orders.push_back({McpCommand::kReportMask, mask});
  orders.push_back({McpCommand::kReportPeriod, report_period_ticks(settings)});
  return orders;
}

}  // namespace topogeo::devices
