// What a running base has to hear besides motion: its watchdog is refreshed, settings that it may
// have missed are repeated, errors acknowledged and the battery's voltage asked for.
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

  /// The base was set up: its battery is asked for at once.
  void set_up(std::int64_t now_ns) { battery_ns_ = now_ns; }
  /// The watchdog is due now.
  void refresh(std::int64_t now_ns) { refresh_ns_ = now_ns; }
  /// The base waits for the acknowledgement of an error.
  void acknowledge() { acknowledge_ = true; }

  /// The watchdog if it is due; it goes before motion commands.
  std::optional<McpOrder> next_refresh(std::int64_t now_ns);
  /// The next of the rest that is due. After a refresh one of the settings is repeated, at most
  /// three in a second; accelerations by `motion`.
  std::optional<McpOrder> next(BaseMotion& motion, std::int64_t now_ns);
  [[nodiscard]] std::int64_t due_ns() const;

 private:
  McpOrder watchdog_;
  std::vector<McpOrder> repeatable_;
  std::int64_t refresh_period_ns_;
  std::int64_t battery_period_ns_;
  std::int64_t refresh_ns_ = 0;  // when the watchdog is due
  std::int64_t battery_ns_ = 0;  // when the battery is due
  bool acknowledge_ = false;
  bool repeat_ = false;
  std::int64_t repeat_ns_ = 0;  // when the next setting may be repeated
  unsigned repeated_ = 0;
};

}  // namespace topogeo::devices
