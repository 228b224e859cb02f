// Protocol of a Kobuki (TurtleBot 2): frames of sub-payloads with a checksum, in both directions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

/// Highest speed of a wheel in mm/s.
inline constexpr int kKobukiFastest = 700;

/// Frames a payload: 0xAA 0x55, the length, the payload, and the checksum, which is the exclusive
/// or of the length and all bytes of the payload.
[[nodiscard]] std::vector<std::uint8_t> kobuki_frame(std::span<const std::uint8_t> payload);

struct KobukiCounters {
  std::uint64_t noise_bytes = 0;  ///< bytes outside of frames
  std::uint64_t bad_checksum = 0;
  std::uint64_t bad_fields = 0;  ///< frames whose sub-payloads do not fit
  bool operator==(const KobukiCounters&) const = default;
};

/// Finds frames in a stream of bytes that may be cut at any byte.
class KobukiReader {
 public:
  void push(std::span<const std::uint8_t> bytes);
  /// Payload of the next complete frame; empty until more bytes come.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> next();
  void clear() { bytes_.clear(); }
  [[nodiscard]] const KobukiCounters& counters() const { return counters_; }

 private:
  std::deque<std::uint8_t> bytes_;
  KobukiCounters counters_;
};

/// Basic sensor data, and the angle of the gyro.
struct KobukiReport {
  std::uint16_t time_ms = 0;             ///< wraps
  std::uint8_t bumpers = 0;              ///< 1: right, 2: central, 4: left
  std::uint8_t drops = 0;                ///< 1: right wheel, 2: left wheel
  std::uint8_t cliffs = 0;               ///< 1: right, 2: central, 4: left
  std::array<std::uint16_t, 2> ticks{};  ///< left and right, growing forwards; wrap
  std::uint8_t charger = 0;              ///< 0: none; kKobukiCable is set when it charges by cable
  std::uint8_t battery_dv = 0;           ///< in 0.1 V
  std::uint8_t overcurrent = 0;          ///< 1: left motor, 2: right motor
  std::optional<std::int16_t> heading_cdeg{};  ///< by the gyro, in 0.01 degrees, counter-clockwise
  bool operator==(const KobukiReport&) const = default;
};
inline constexpr unsigned kKobukiCable = 16;

/// Finds reports; frames without basic sensor data are skipped.
class KobukiDecoder {
 public:
  void push(std::span<const std::uint8_t> bytes) { reader_.push(bytes); }
  [[nodiscard]] std::optional<KobukiReport> next();
  void clear() { reader_.clear(); }
  [[nodiscard]] KobukiCounters counters() const;

 private:
  KobukiReader reader_;
  std::uint64_t bad_fields_ = 0;
};

/// The frame in which the base sends this report.
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const KobukiReport& report);

/// Fields of the command "base control"; kobuki_motion() gives their meaning.
struct KobukiMotion {
  std::int16_t speed_mmps = 0;
  std::int16_t radius_mm = 0;
  bool operator==(const KobukiMotion&) const = default;
};
/// Encodes a motion as the maker's driver does. Straight: radius 0. Turn on the spot: radius 1 and
/// the speed of the right wheel. Otherwise: the radius of the robot's centre, positive to the left,
/// and the speed of the outer wheel. If a wheel would exceed kKobukiFastest, both velocities are
/// scaled down by the same factor.
[[nodiscard]] KobukiMotion kobuki_motion(double linear_mps, double angular_radps, double track_m);
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const KobukiMotion& motion);
/// Decodes a payload; empty if it is no "base control" command.
[[nodiscard]] std::optional<KobukiMotion> kobuki_motion(std::span<const std::uint8_t> payload);

}  // namespace topogeo::devices
