// Encoder counts, position units, rotation counts and clock ticks of an RWI base as metres, radians
// and nanoseconds, and the base's own frame (heading like a compass) as the robot's.
#pragma once

#include <cstdint>

#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {

/// What differs from base to base. Not confirmed on hardware: a wrong `counts_per_m` is a robot
/// that drives twice as far as commanded, so measure it before the first drive.
struct McpCalibration {
  /// Encoder counts of a metre; 28120 for a B21 with 500 counts per motor turn, a reduction of
  /// 19.75 and wheels of 4.4 inches, 25630 for a B21b (18.0); others were measured to 54820.
  double counts_per_m = 28120.0;
  /// Units of BPX and BPY in a metre; 0 stands for counts_per_m / 256.
  double position_units_per_m = 0.0;
  double rotation_counts_per_turn = 1024.0;
  /// The base counts rotation clockwise; other RWI bases count the other direction.
  bool clockwise_positive = true;
  /// Forward of the base is backward of the robot.
  bool reversed = false;
};

inline constexpr std::int64_t kMcpTicksPerSecond = 256;

/// Throws std::invalid_argument with the name of a value that is not finite or not positive.
class McpUnits {
 public:
  explicit McpUnits(const McpCalibration& calibration);

  /// Encoder counts of a distance, speed or acceleration; rounded, sign as of the base.
  [[nodiscard]] std::int64_t counts(double m) const;
  /// Rotation counts of an angle, speed or acceleration counted counter-clockwise; rounded, sign as
  /// of the base.
  [[nodiscard]] std::int64_t rotation_counts(double rad) const;
  [[nodiscard]] double metres(std::int64_t counts) const;
  [[nodiscard]] double radians(std::int64_t rotation_counts) const;

  /// Speeds of a report with TVE and TSF, RVE and RSF; along x of the robot and counter-clockwise.
  [[nodiscard]] double linear_mps(const McpReport& report) const;
  [[nodiscard]] double angular_radps(const McpReport& report) const;

  /// Position units as metres of the base's odometry frame: x ahead at heading 0, y to the left.
  [[nodiscard]] double position_m(std::int64_t units) const;
  [[nodiscard]] double position_units(double m) const;
  [[nodiscard]] double clockwise_sign() const { return clockwise_sign_; }

 private:
  double counts_per_m_;
  double units_per_m_;
  double rotation_per_rad_;
  double forward_sign_;
  double clockwise_sign_;  // +1 where the base counts clockwise
};

/// Follows BPX, BPY and TPH over their wrap-around. Positions are of the base's odometry frame,
/// whose origin is where its registers stand at 0x8000, 0x8000 and 0.
class McpPoseTracker {
 public:
  explicit McpPoseTracker(const McpUnits& units) : units_(units) {}

  /// T_base_robot of a report with BPX, BPY and TPH. Between two reports the base must move less
  /// than half the range of its registers (298 m on a B21).
  geometry::Pose2 track(const McpReport& report);
  /// Where the report would put the robot, without taking it.
  [[nodiscard]] geometry::Pose2 peek(const McpReport& report) const;
  /// Takes the registers of the next report as they are: after the base has restarted.
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

/// A clock of 1/256 s and 32 bits, which wraps after half a year, as one that does not.
class McpClock {
 public:
  /// Nanoseconds since the first reading after `restart`; earlier ones are negative.
  std::int64_t follow(std::uint32_t ticks);
  /// From the last reading to this one, negative if that is nearer, without taking it.
  [[nodiscard]] std::int64_t since_last_ns(std::uint32_t ticks) const;
  void restart() { started_ = false; }

 private:
  bool started_ = false;
  std::uint32_t last_ = 0;
  std::int64_t ticks_ = 0;
};

/// Nanoseconds of a number of ticks.
constexpr std::int64_t ticks_ns(std::int64_t ticks) {
  return ticks * (1'000'000'000 / kMcpTicksPerSecond);
}
static_assert(1'000'000'000 % kMcpTicksPerSecond == 0);

}  // namespace topogeo::devices
