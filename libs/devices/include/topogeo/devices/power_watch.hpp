// Whether an axis of a base moves as it was commanded, or something holds it against its motor: the
// emergency stop, which takes the power of the motors and for which an RWI base has no message, or
// hands on the wheels. Judged by the base's own reports and their own times alone, so that a host
// that is busy, a slow line or a lost command is never taken for it (own). What is commanded counts
// from the moment on at which it has been written to the line.
//
// The base says what it does: its phase (accelerates, runs at the commanded speed, slows down,
// halts) and the commanded direction. From one report to the next a motor with power
//   - gains speed while it accelerates;
//   - keeps its speed while it runs at the commanded one, unless a slower one was commanded lately;
//   - loses no more than its acceleration allows when it slows down.
// An axis that says that it accelerates and has less speed than that has lost its power, and so has
// one that slows down by more, and one that moved as commanded and rests, though not told to.
//
// A report may be garbled on the line (the ASCII dialect has no checksum). So the next one must
// bear it out: no motor gets faster by more than it accelerates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// The part of a report that is about one axis, in m/s or rad/s.
struct AxisReport {
  std::int64_t base_ns = 0;   ///< by the clock of the base
  std::int64_t stamp_ns = 0;  ///< the same by the clock of the host, about
  double speed = 0.0;         ///< as measured
  McpPhase phase = McpPhase::kStop;
  double commanded_sign = 1.0;  ///< 1 or -1, the direction that the base was told last
};

/// Deviations that are no loss of power yet; in m/s or rad/s, each > 0.
struct PowerTolerance {
  double standstill = 0.0;  ///< slower is standstill: the noise of the encoders reaches it
  double ripple = 0.0;      ///< that a regulated speed is below the commanded one
  double ramp = 0.0;        ///< that the speed lags behind while it accelerates
};

class PowerWatch {
 public:
  /// `period_ns`: between two reports.
  PowerWatch(const PowerTolerance& tolerance, std::int64_t period_ns);

  /// The speed that is commanded from now on, 0 to stand, and the acceleration of the base (> 0).
  /// Until it is written the base may obey it or an earlier one.
  void aim_at(double speed, double acceleration, std::int64_t now_ns);
  /// All that was commanded so far has been written to the line by now.
  void written(std::int64_t now_ns);
  /// Earlier reports do not count any more: the base has started anew, or has stopped for a
  /// reason that is known (a bumper, its watchdog, a joystick).
  void forget();
  /// The next report, in the order of their times. True: the axis has lost its power.
  bool take(const AxisReport& report);

 private:
  /// The part of a report that the next one is compared with.
  struct Before {
    std::int64_t base_ns = 0;
    std::int64_t stamp_ns = 0;
    double speed = 0.0;
    double due = 0.0;  ///< the least speed in the direction of the motion that it should have had
    McpPhase phase = McpPhase::kStop;
    double commanded_sign = 1.0;
    bool sound = false;    ///< not faster than the one before it allows
    bool suspect = false;  ///< slower than it can be with power
  };
  struct Aim {
    std::int64_t since_ns = 0;
    double speed = 0.0;
    std::optional<std::int64_t> written_ns{};
  };

  [[nodiscard]] static bool is_obeyed(const Aim& aim, std::int64_t stamp_ns);
  /// Index of the oldest aim that the base may be obeying at that time.
  [[nodiscard]] std::size_t oldest_aim(std::int64_t stamp_ns) const;
  [[nodiscard]] double least_aim(std::int64_t stamp_ns) const;
  [[nodiscard]] double step_s(const AxisReport& report) const;
  /// Reports are missing between this one and the one before.
  [[nodiscard]] bool follows_gap(const AxisReport& report) const;
  [[nodiscard]] bool faster(const AxisReport& report) const;
  [[nodiscard]] bool dropped(const AxisReport& report) const;
  [[nodiscard]] double due(const AxisReport& report, double least_aim) const;
  [[nodiscard]] bool too_slow(const AxisReport& report, double due, double least_aim) const;
  bool rests(const AxisReport& report, double least_aim);

  PowerTolerance tolerance_;
  std::int64_t longest_step_ns_;
  std::deque<Aim> aims_;
  double acceleration_ = 1.0;
  double direction_ = 0.0;       ///< of the motion that is commanded; 0: to stand
  std::int64_t changed_ns_ = 0;  ///< when the acceleration has changed, or was written
  bool change_written_ = true;
  std::optional<Before> before_{};
  bool obeyed_ = false;  ///< the commanded motion was reported
  McpPhase rest_phase_ = McpPhase::kStop;
  std::optional<std::int64_t> rests_since_ns_{};  ///< in that phase, by the clock of the base
};

}  // namespace topogeo::devices
