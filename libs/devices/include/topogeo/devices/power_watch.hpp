// Detects whether an axis of a base moves as commanded, or is held against its motor: by the
// emergency stop, which takes the power of the motors and for which an RWI base has no message, or
// by hands on the wheels. Uses only the base's own reports and their own times, so that a busy
// host, a slow line or a lost command is never taken for it (own). A command counts from the moment
// it has been written to the line.
//
// The base reports its phase (accelerates, runs at the commanded speed, slows down, halts) and the
// commanded direction. Between two reports, a motor with power
//   - gains speed while it accelerates;
//   - keeps its speed while it runs at the commanded one, unless a slower one was commanded lately;
//   - loses no more than its acceleration allows when it slows down.
// An axis has lost its power if it reports acceleration but has less speed than that, if it slows
// down by more, or if it moved as commanded and now rests without a command to.
//
// A report may be garbled on the line (the ASCII dialect has no checksum). So the next one must
// confirm it: no motor gets faster by more than it accelerates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// The part of a report about one axis, in m/s or rad/s.
struct AxisReport {
  std::int64_t base_ns = 0;   ///< on the clock of the base
  std::int64_t stamp_ns = 0;  ///< the same on the clock of the host, approximately
  double speed = 0.0;         ///< as measured
  McpPhase phase = McpPhase::kStop;
  double commanded_sign = 1.0;  ///< 1 or -1, the last commanded direction
};

/// Deviations that do not count as loss of power; in m/s or rad/s, each > 0.
struct PowerTolerance {
  double standstill = 0.0;  ///< lower speeds are standstill; encoder noise reaches it
  double ripple = 0.0;      ///< of a regulated speed below the commanded one
  double ramp = 0.0;        ///< of the speed behind the ramp while it accelerates
};

class PowerWatch {
 public:
  /// `period_ns`: between two reports.
  PowerWatch(const PowerTolerance& tolerance, std::int64_t period_ns);

  /// The speed that is commanded from now on, 0 to stand, and the acceleration of the base (> 0).
  /// Until it is written, the base may obey it or an earlier one.
  void aim_at(double speed, double acceleration, std::int64_t now_ns);
  /// All commands so far have been written to the line.
  void written(std::int64_t now_ns);
  /// Discards earlier reports: the base has restarted, or has stopped for a known reason (a bumper,
  /// its watchdog, a joystick).
  void forget();
  /// The next report, in the order of their times. True: the axis has lost its power.
  bool take(const AxisReport& report);

 private:
  /// The part of a report that the next one is compared with.
  struct Before {
    std::int64_t base_ns = 0;
    std::int64_t stamp_ns = 0;
    double speed = 0.0;
    double due = 0.0;  ///< the least expected speed in the direction of the motion
    McpPhase phase = McpPhase::kStop;
    double commanded_sign = 1.0;
    bool sound = false;    ///< not faster than the previous one allows
    bool suspect = false;  ///< slower than a motor with power can be
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
  /// Reports are missing between this one and the previous one.
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
  double direction_ = 0.0;       ///< of the commanded motion; 0: to stand
  std::int64_t changed_ns_ = 0;  ///< when the acceleration was changed or written
  bool change_written_ = true;
  std::optional<Before> before_{};
  bool obeyed_ = false;  ///< the commanded motion was reported
  McpPhase rest_phase_ = McpPhase::kStop;
  std::optional<std::int64_t> rests_since_ns_{};  ///< start of the rest, on the clock of the base
};

}  // namespace topogeo::devices
