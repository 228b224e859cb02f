// The commands that set a base up, in the order of the known drivers.
#pragma once

#include <vector>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// To a base that understands commands: the joystick out of the way, echo off, errors and bumpers,
/// torques, what the reports hold, their period, the watchdog. The fields come before the period.
std::vector<McpOrder> set_up_orders(const BaseSettings& settings);

/// Those of them that the base may have missed without a sign of it.
std::vector<McpOrder> silent_orders(const BaseSettings& settings);

/// The watchdog's time in 1/256 s.
McpOrder watchdog_order(const BaseSettings& settings);

}  // namespace topogeo::devices
