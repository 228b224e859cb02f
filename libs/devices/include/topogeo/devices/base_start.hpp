// The commands that set a base up, in the order of the known drivers.
#pragma once

#include <vector>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// Commands for a base that already understands them: joystick, echo off, errors and bumpers,
/// torques, contents of the reports, their period, the watchdog. The fields come before the period.
std::vector<McpOrder> set_up_orders(const BaseSettings& settings);

/// The commands among them that the base may miss without a sign of it.
std::vector<McpOrder> silent_orders(const BaseSettings& settings);

/// The watchdog's time in 1/256 s.
McpOrder watchdog_order(const BaseSettings& settings);

}  // namespace topogeo::devices
