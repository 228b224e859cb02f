#include "topogeo/devices/base_upkeep.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "topogeo/devices/base_start.hpp"

namespace topogeo::devices {
namespace {

/// The base stops only after four lost refreshes, or when the host is busy for that long.
constexpr std::int64_t kRefreshesPerWatchdog = 5;
/// Between two repeated settings: on a slow line each takes a tenth of this time, which motion
/// commands need more.
constexpr std::int64_t kRepeatPeriod_ns = 300'000'000;
/// The accelerations of the two axes, repeated like the settings of the start sequence.
constexpr std::size_t kAccelerations = 2;

}  // namespace

BaseUpkeep::BaseUpkeep(const BaseSettings& settings)
    : watchdog_(watchdog_order(settings)),
      repeatable_(silent_orders(settings)),
      refresh_period_ns_(static_cast<std::int64_t>(settings.watchdog_s * 1e9) /
                         kRefreshesPerWatchdog),
      battery_period_ns_(static_cast<std::int64_t>(settings.battery_period_s * 1e9)) {}

std::optional<McpOrder> BaseUpkeep::next_refresh(std::int64_t now_ns) {
  if (now_ns < refresh_ns_) return std::nullopt;
  refresh_ns_ = now_ns + refresh_period_ns_;
  if (now_ns >= repeat_ns_) repeat_ = true;
  return watchdog_;
}

std::optional<McpOrder> BaseUpkeep::next(BaseMotion& motion, std::int64_t now_ns) {
  if (std::exchange(acknowledge_, false)) return McpOrder{McpCommand::kAcknowledge, 0};
  if (std::exchange(repeat_, false)) {
    repeat_ns_ = now_ns + kRepeatPeriod_ns;
    const std::size_t index = repeated_++ % (repeatable_.size() + kAccelerations);
    return index < repeatable_.size() ? repeatable_[index] : motion.repeat_acceleration();
  }
  if (now_ns >= battery_ns_) {
    battery_ns_ = now_ns + battery_period_ns_;
    return McpOrder{McpCommand::kBatteryVoltage};
  }
  return std::nullopt;
}

std::int64_t BaseUpkeep::due_ns() const {
  return std::min(refresh_ns_, battery_ns_);
}

}  // namespace topogeo::devices
