// Packets of LDROBOT lasers (LD06, LD19, STL-19P): what the laser sends without being asked.
//
// Source: Shenzhen LDROBOT, "LD19 Development Manual" and "LD06 Development Manual": 47 bytes with
// the header 0x54, one byte with version and number of measurements (0x2C), speed, start angle,
// twelve times distance and intensity, end angle, time stamp and a CRC-8 (polynomial 0x4D).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

inline constexpr std::size_t kLdPoints = 12;
inline constexpr std::size_t kLdPacket_bytes = 47;
inline constexpr std::uint32_t kLdTimeWrap_ms = 30'000;
inline constexpr unsigned kLdTurnCdeg = 36'000;

struct LdPoint {
  std::uint16_t distance_mm = 0;  ///< 0: no return
  std::uint8_t intensity = 0;
  bool operator==(const LdPoint&) const = default;
};

struct LdPacket {
  std::uint16_t speed_deg_s = 0;
  std::uint16_t start_cdeg = 0;  ///< hundredths of a degree, clockwise, of the first point
  std::uint16_t end_cdeg = 0;    ///< of the last point; the others lie between at equal steps
  std::uint16_t time_ms = 0;     ///< counts to kLdTimeWrap_ms, then from 0 again
  std::array<LdPoint, kLdPoints> points{};
  bool operator==(const LdPacket&) const = default;

  /// Angle from the first point to the last, hundredths of a degree.
  [[nodiscard]] unsigned span_cdeg() const {
    return (kLdTurnCdeg + end_cdeg - start_cdeg) % kLdTurnCdeg;
  }
};

[[nodiscard]] std::uint8_t ld_crc(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::vector<std::uint8_t> ld_bytes(const LdPacket& packet);

/// Counts of dropped bytes and packets.
struct LdCounters {
  std::uint64_t noise_bytes = 0;   ///< outside of packets
  std::uint64_t bad_checksum = 0;  ///< packets, also apparent ones
  std::uint64_t implausible = 0;   ///< packets with angles or a speed that no laser has
  bool operator==(const LdCounters&) const = default;
};

/// Finds packets in a stream of bytes that is cut anywhere.
class LdDecoder {
 public:
  struct Found {
    LdPacket packet;
    std::size_t bytes_since = 0;  ///< that were received after the packet
  };

  void push(std::span<const std::uint8_t> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  /// The next packet; empty: more bytes are needed.
  [[nodiscard]] std::optional<Found> next();
  void clear() { buffer_.clear(); }
  [[nodiscard]] const LdCounters& counters() const { return counters_; }

 private:
  std::deque<std::uint8_t> buffer_;
  LdCounters counters_;
};

}  // namespace topogeo::devices
