// The wanted motion of a base and the MCP commands still to be sent for it: velocities and relative
// moves, each command only when it changes something.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/devices/mcp_units.hpp"

namespace topogeo::devices {

/// The commands that differ between the two axes.
struct BaseAxisCommands {
  McpCommand velocity, acceleration, halt, plus, minus, relative_plus, relative_minus;
};

/// One motor's axis, in its own counts.
class BaseAxis {
 public:
  explicit BaseAxis(const BaseAxisCommands& commands) : commands_(commands) {}

  void want_speed(std::int64_t counts_per_s);
  /// A move by `counts` with at most `counts_per_s`; it is sent once.
  void want_distance(std::int64_t counts, std::int64_t counts_per_s);
  void want_acceleration(std::int64_t counts_per_s2);
  /// Call when the base may have forgotten earlier commands.
  void forget();
  /// Call when the base may have missed the last run or halt.
  void forget_run() { sent_ = Run::kUnknown; }
  /// The wanted relative move was sent.
  [[nodiscard]] bool distance_sent() const { return sent_ == Run::kRelative; }
  [[nodiscard]] bool moves() const { return wanted_ != Run::kHalt; }
  /// A halt is wanted and was sent.
  [[nodiscard]] bool halt_sent() const { return wanted_ == Run::kHalt && sent_ == Run::kHalt; }

  /// The halt command, if it has to be sent.
  std::optional<McpOrder> next_halt();
  /// The next command to send, if any; counts as sent.
  std::optional<McpOrder> next();
  /// The acceleration, even if it was sent before.
  [[nodiscard]] McpOrder acceleration() const;

 private:
  enum class Run : std::uint8_t { kUnknown, kHalt, kPlus, kMinus, kRelative };

  BaseAxisCommands commands_;
  Run wanted_ = Run::kHalt;
  std::uint32_t speed_ = 0;
  std::int64_t distance_ = 0;
  std::uint32_t acceleration_ = 1;
  Run sent_ = Run::kUnknown;
  std::optional<std::uint32_t> sent_speed_{};
  std::optional<std::uint32_t> sent_acceleration_{};
};

class BaseMotion {
 public:
  BaseMotion(const McpUnits& units, const BaseLimits& limits);

  /// Reduces speeds beyond the limits, both by the same factor, so that the robot keeps to the
  /// curve.
  void want_velocity(const BaseVelocity& velocity);
  void want_distance(double distance_m);
  void want_turn(double angle_rad);
  void want_halt() { want_velocity({}); }
  /// Applies to all later motion, accelerations at once.
  void set_limits(const BaseLimits& limits);
  [[nodiscard]] const BaseLimits& limits() const { return limits_; }
  /// The base may have forgotten earlier commands: all are sent again.
  void forget();
  /// The base does not obey the last command: it is sent again, without speeds and accelerations.
  void forget_run();

  /// Halts first, then settings before the motion that needs them.
  std::optional<McpOrder> next();
  std::optional<McpOrder> next_halt();
  /// Accelerations again, alternating between the axes: the base may have missed them.
  McpOrder repeat_acceleration();

  [[nodiscard]] bool moves() const { return translation_.moves() || rotation_.moves(); }
  /// Halts of both axes are wanted and were sent.
  [[nodiscard]] bool halt_sent() const { return translation_.halt_sent() && rotation_.halt_sent(); }
  [[nodiscard]] bool translates() const { return translation_.moves(); }
  [[nodiscard]] bool rotates() const { return rotation_.moves(); }
  /// A relative move is wanted and all its commands were sent.
  [[nodiscard]] bool relative_sent() const;
  /// The velocity that the base will reach; for a relative move its highest.
  [[nodiscard]] const BaseVelocity& aim() const { return aim_; }

 private:
  McpUnits units_;
  BaseLimits limits_;
  BaseAxis translation_;
  BaseAxis rotation_;
  BaseVelocity aim_{};
  bool repeat_rotation_ = false;
};

}  // namespace topogeo::devices
