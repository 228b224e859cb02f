// Converts encoder counts, position units, rotation counts and clock ticks of an RWI base to
// metres, radians and nanoseconds, and the base's own frame (heading like a compass) to the
// robot's.
#pragma once

#include <cstdint>

#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {

/// Values that differ between bases. Not confirmed on hardware: a wrong `counts_per_m` makes a
/// robot drive, say, twice as far as commanded, so measure it before the first drive.
struct McpCalibration {
  /// Encoder counts per metre; 28120 for a B21 with 500 counts per motor turn, a reduction of 19.75
  /// and wheels of 4.4 inches, 25630 for a B21b (18.0); measured values of others reach 54820.
  double counts_per_m = 28120.0;
  /// Units of BPX and BPY per metre; 0: counts_per_m / 256.
  double position_units_per_m = 0.0;
  double rotation_counts_per_turn = 1024.0;
  /// A B21 counts rotation clockwise; other RWI bases count counter-clockwise.
  bool clockwise_positive = true;
  /// The base's forward direction is the robot's backward direction.
  bool reversed = false;
};

inline constexpr std::int64_t kMcpTicksPerSecond = 256;

/// Throws std::invalid_argument with the name of a value that is not finite or not positive.
class McpUnits {
 public:
  explicit McpUnits(const McpCalibration& calibration);

  /// Encoder counts of a distance, speed or acceleration; rounded, with the base's sign.
  [[nodiscard]] std::int64_t counts(double m) const;
  /// Rotation counts of a counter-clockwise angle, speed or acceleration; rounded, with the base's
  /// sign.
  [[nodiscard]] std::int64_t rotation_counts(double rad) const;
  [[nodiscard]] double metres(std::int64_t counts) const;
  [[nodiscard]] double radians(std::int64_t rotation_counts) const;

  /// Speeds from a report with TVE and TSF, RVE and RSF; along x of the robot and
  /// counter-clockwise.
  [[nodiscard]] double linear_mps(const McpReport& report) const;
  [[nodiscard]] double angular_radps(const McpReport& report) const;

  /// Converts position units to metres in the base's odometry frame: x ahead at heading 0, y left.
  [[nodiscard]] double position_m(std::int64_t units) const;
  [[nodiscard]] double position_units(double m) const;
  [[nodiscard]] double clockwise_sign() const { return clockwise_sign_; }

 private:
  double counts_per_m_;
  double units_per_m_;
  double rotation_per_rad_;
  double forward_sign_;
  double clockwise_sign_;  // +1 if the base counts clockwise
};

/// Follows BPX, BPY and TPH over their wrap-around. Positions are in the base's odometry frame,
/// whose origin has the register values 0x8000, 0x8000 and 0.
class McpPoseTracker {
 public:
  explicit McpPoseTracker(const McpUnits& units) : units_(units) {}

  /// T_base_robot of a report with BPX, BPY and TPH. Between two reports the base must move less
  /// than half the range of its registers (298 m on a B21).
  geometry::Pose2 track(const McpReport& report);
  /// The pose that the report would give, without applying it.
  [[nodiscard]] geometry::Pose2 peek(const McpReport& report) const;
  /// After a restart of the base, takes the registers of the next report as they are.
  void restart() { started_ = false; }

 private:
  struct Registers {
    std::int64_t x = 0;
    std::int64_t y = 0;
    std::uint16_t heading = 0;
  };
  [[nodiscard]] Registers next(const McpReport& report) const;
  [[nodiscard]] geometry::Pose2 pose_of(const Registers& registers) const;

  McpUnits units_;
  bool started_ = false;
  Registers last_{};
};

/// Unwraps a clock of 1/256 s and 32 bits, which wraps after half a year.
class McpClock {
 public:
  /// Nanoseconds since the first reading after `restart`; earlier ones are negative.
  std::int64_t follow(std::uint32_t ticks);
  /// Time between the last reading and this one, negative if that is nearer, without applying it.
  [[nodiscard]] std::int64_t since_last_ns(std::uint32_t ticks) const;
  void restart() { started_ = false; }

 private:
  bool started_ = false;
  std::uint32_t last_ = 0;
  std::int64_t ticks_ = 0;
};

/// Converts a number of ticks to nanoseconds.
constexpr std::int64_t ticks_ns(std::int64_t ticks) {
  return ticks * (1'000'000'000 / kMcpTicksPerSecond);
}
static_assert(1'000'000'000 % kMcpTicksPerSecond == 0);

}  // namespace topogeo::devices
