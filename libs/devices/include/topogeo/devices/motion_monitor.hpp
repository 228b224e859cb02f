// Detects whether a base moves as commanded: motion without a command is the joystick, commanded
// motion that does not happen is the emergency stop. The base has no message for either;
// power_watch.hpp detects the second within two reports.
#pragma once

#include <cstdint>

#include "topogeo/devices/base_motion.hpp"
#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/devices/mcp_units.hpp"
#include "topogeo/devices/power_watch.hpp"

namespace topogeo::devices {

/// The speeds of one axis that commands explain: between the least and the largest command that
/// holds or, during a change, held before. A base may always be slower.
class SpeedRange {
 public:
  /// The base reaches it with `acceleration` (> 0), starting after `lag_ns` at the latest.
  void aim_at(double speed, double acceleration, std::int64_t lag_ns, std::int64_t now_ns);
  /// Amount by which a speed exceeds the range; 0 within.
  double excess(double speed, std::int64_t now_ns);
  [[nodiscard]] bool settled(std::int64_t now_ns) const { return now_ns >= settled_ns_; }

 private:
  double aim_ = 0.0;
  double least_ = 0.0;
  double largest_ = 0.0;
  std::int64_t settled_ns_ = 0;
};

class MotionMonitor {
 public:
  MotionMonitor(const McpUnits& units, const BaseSettings& settings);

  /// The motion that is commanded from now on.
  void aim_at(const BaseVelocity& velocity, const BaseLimits& limits, std::int64_t now_ns);
  /// The last of these motions has been written to the base: it obeys within its lag.
  void written(std::int64_t now_ns) {
    linear_power_.written(now_ns);
    angular_power_.written(now_ns);
  }
  /// The base restarted: motion soon after `now_ns` may come from an earlier command.
  void restart(std::int64_t now_ns);
  /// The base has stopped for a known reason, or an operator permits motion again.
  void forget_power();
  /// A relative move, which the base ends by itself, is commanded: its end is no loss of power.
  void leave_power(const BaseLimits& limits, std::int64_t now_ns);
  /// A report that the base took at `stamp_ns` of the host's clock and that arrived now.
  void take(const McpReport& report, const BaseMotion& motion, std::int64_t stamp_ns,
            std::int64_t now_ns);

  /// Whether the base stood in the last report.
  [[nodiscard]] bool stands() const { return stands_; }
  /// A motor brakes.
  [[nodiscard]] bool slows_down() const { return slows_down_; }
  /// A motor is without power, by a command or because of an error.
  [[nodiscard]] bool limp() const { return limp_; }
  /// Driven by joystick; holds until the base has stood for a second.
  [[nodiscard]] bool joystick() const { return joystick_; }
  /// The base was commanded to move, and an axis has lost its power or does not start for
  /// settings.stalled_reports reports.
  [[nodiscard]] bool stalled() const { return lost_power_ || stalls_ >= settings_.stalled_reports; }
  /// The base should have started or stopped by now: a command was lost.
  [[nodiscard]] bool disobeys() const { return disobeys_; }
  /// Number of reports since it stands.
  [[nodiscard]] unsigned reports_standing() const { return reports_standing_; }

 private:
  void watch_power(const McpReport& report, std::int64_t stamp_ns);

  McpUnits units_;
  BaseSettings settings_;
  std::int64_t period_ns_;
  McpClock clock_;
  PowerWatch linear_power_;
  PowerWatch angular_power_;
  bool lost_power_ = false;
  SpeedRange linear_;
  SpeedRange angular_;
  bool stands_ = true;
  bool slows_down_ = false;
  bool limp_ = false;
  bool joystick_ = false;
  bool disobeys_ = false;
  unsigned stalls_ = 0;
  unsigned uncommanded_ = 0;
  unsigned reports_standing_ = 0;
  std::int64_t moved_ns_ = 0;  // last time in motion
};

}  // namespace topogeo::devices
