// Commands that a running base needs besides motion: watchdog refreshes, repetition of settings
// that it may have missed, acknowledgement of errors and requests of the battery voltage.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/devices/base_motion.hpp"
#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

class BaseUpkeep {
 public:
  explicit BaseUpkeep(const BaseSettings& settings);

  /// The base was set up: requests its battery voltage at once.
  void set_up(std::int64_t now_ns) { battery_ns_ = now_ns; }
  /// The watchdog is due now.
  void refresh(std::int64_t now_ns) { refresh_ns_ = now_ns; }
  /// The base waits for the acknowledgement of an error.
  void acknowledge() { acknowledge_ = true; }

  /// The watchdog refresh if it is due; it goes before motion commands.
  std::optional<McpOrder> next_refresh(std::int64_t now_ns);
  /// The next other command that is due. After a refresh one of the settings is repeated, at most
  /// three in a second; `motion` supplies the accelerations.
  std::optional<McpOrder> next(BaseMotion& motion, std::int64_t now_ns);
  [[nodiscard]] std::int64_t due_ns() const;

 private:
  McpOrder watchdog_;
  std::vector<McpOrder> repeatable_;
  std::int64_t refresh_period_ns_;
  std::int64_t battery_period_ns_;
  std::int64_t refresh_ns_ = 0;  // next refresh of the watchdog
  std::int64_t battery_ns_ = 0;  // next request of the battery voltage
  bool acknowledge_ = false;
  bool repeat_ = false;
  std::int64_t repeat_ns_ = 0;  // earliest repetition of the next setting
  unsigned repeated_ = 0;
};

}  // namespace topogeo::devices
