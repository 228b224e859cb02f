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

/// mm/s of a wheel.
inline constexpr int kKobukiFastest = 700;

/// 0xAA 0x55, the length, the payload, and a checksum that makes the exclusive or of all bytes from
/// the length on 0.
[[nodiscard]] std::vector<std::uint8_t> kobuki_frame(std::span<const std::uint8_t> payload);

struct KobukiCounters {
  std::uint64_t noise_bytes = 0;  ///< outside of frames
  std::uint64_t bad_checksum = 0;
  std::uint64_t bad_fields = 0;  ///< frames whose sub-payloads do not fit
  bool operator==(const KobukiCounters&) const = default;
};

/// Finds frames in a stream of bytes that is cut anywhere.
class KobukiReader {
 public:
  void push(std::span<const std::uint8_t> bytes);
  /// The payload of the next frame.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> next();
  void clear() { bytes_.clear(); }
  [[nodiscard]] const KobukiCounters& counters() const { return counters_; }

 private:
  std::deque<std::uint8_t> bytes_;
  KobukiCounters counters_;
};

/// Basic sensor data, and the angle of the gyro.
struct KobukiReport {
  std::uint16_t time_ms = 0;                   ///< wraps
  std::uint8_t bumpers = 0;                    ///< 1: right, 2: central, 4: left
  std::uint8_t drops = 0;                      ///< 1: right wheel, 2: left wheel
  std::uint8_t cliffs = 0;                     ///< 1: right, 2: central, 4: left
  std::array<std::uint16_t, 2> ticks{};        ///< left and right, forward; wrap
  std::uint8_t charger = 0;                    ///< 0: none; bit 16: by cable
  std::uint8_t battery_dv = 0;                 ///< 0.1 V
  std::uint8_t overcurrent = 0;                ///< 1: left motor, 2: right motor
  std::optional<std::int16_t> heading_cdeg{};  ///< of the gyro, counter-clockwise
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

/// A frame with these data, as the base sends it.
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const KobukiReport& report);

/// Data of the order "base control".
struct KobukiMotion {
  std::int16_t speed_mmps = 0;
  std::int16_t radius_mm = 0;
  bool operator==(const KobukiMotion&) const = default;
};
/// The encoding of the maker's driver. Straight: radius 0. On the spot: radius 1, and the speed of
/// the right wheel. Otherwise the radius of the middle, positive to the left, and the speed of the
/// outer wheel. Both velocities are cut by the same share if a wheel is faster than kKobukiFastest.
[[nodiscard]] KobukiMotion kobuki_motion(double linear_mps, double angular_radps, double track_m);
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const KobukiMotion& motion);
/// Empty for another payload.
[[nodiscard]] std::optional<KobukiMotion> kobuki_motion(std::span<const std::uint8_t> payload);

}  // namespace topogeo::devices
