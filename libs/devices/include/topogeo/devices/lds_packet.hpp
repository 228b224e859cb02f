// Packets of the ROBOTIS LDS-01 (Hitachi-LG HLS-LFCD2) and the laser of the Neato XV-11: a few
// readings of one degree each, with the number of the packet in the turn.
//
// Sources: for the XV-11, N. Saugnier's description of its protocol (firmware 2.4 and 2.6) and the
// ROS driver xv_11_laser_driver; for the LDS-01, ROBOTIS' own driver hls_lfcd_lds_driver, which
// reads no checksum. One public driver (kaia.ai, LDS) checks the LDS-01 by the rule of the XV-11.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/lds_settings.hpp"

namespace topogeo::devices {

/// The differences between the two lasers.
struct LdsFormat {
  std::size_t readings = 0;       ///< of a packet, one degree apart
  std::size_t reading_bytes = 0;  ///< of one reading
  std::size_t packets = 0;        ///< of a turn
  double rpm_per_unit = 0.0;      ///< turns a minute of one unit of the speed
  bool flags = false;             ///< the upper two bits of a distance are marks
  bool intensity_first = false;   ///< intensity before distance
  bool clockwise = false;         ///< sense of the readings, seen from above

  [[nodiscard]] constexpr std::size_t packet_bytes() const {
    return 4 + readings * reading_bytes + 2;
  }
};
inline constexpr LdsFormat kXv11{.readings = 4,
                                 .reading_bytes = 4,
                                 .packets = 90,
                                 .rpm_per_unit = 1.0 / 64.0,
                                 .flags = true,
                                 .intensity_first = false,
                                 .clockwise = false};
inline constexpr LdsFormat kLds01{.readings = 6,
                                  .reading_bytes = 6,
                                  .packets = 60,
                                  .rpm_per_unit = 0.1,
                                  .flags = false,
                                  .intensity_first = true,
                                  .clockwise = true};

struct LdsReading {
  std::uint16_t distance_mm = 0;  ///< 0: no return
  std::uint16_t intensity = 0;
  bool operator==(const LdsReading&) const = default;
};

struct LdsPacket {
  std::size_t number = 0;  ///< in the turn; its first reading lies at this times `readings` degrees
  std::uint16_t speed = 0;  ///< in units of the format
  std::vector<LdsReading> readings;
  bool operator==(const LdsPacket&) const = default;
};

/// The 15-bit checksum over the bytes before it, whose number is even.
[[nodiscard]] std::uint16_t lds_checksum(std::span<const std::uint8_t> bytes);
/// `packet` has the number of readings of the format.
[[nodiscard]] std::vector<std::uint8_t> lds_bytes(const LdsPacket& packet, const LdsFormat& format);

/// Counts of dropped bytes and packets.
struct LdsCounters {
  std::uint64_t noise_bytes = 0;   ///< outside of packets
  std::uint64_t bad_checksum = 0;  ///< packets, also apparent ones
  std::uint64_t alone = 0;         ///< packets that the next one does not follow at once
  std::uint64_t implausible = 0;   ///< packets with a speed that no laser has
  bool operator==(const LdsCounters&) const = default;
};

/// Finds packets in a stream of bytes that is cut anywhere. A packet counts if the header of the
/// next one follows it at once: a weak checksum, or none, is not enough.
class LdsDecoder {
 public:
  struct Found {
    LdsPacket packet;
    std::size_t bytes_since = 0;  ///< that were received after the packet
  };

  LdsDecoder(const LdsFormat& format, LdsChecksum checksum)
      : format_(format), setting_(checksum), checksum_(checksum) {}

  void push(std::span<const std::uint8_t> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  /// The next packet; empty: more bytes are needed.
  [[nodiscard]] std::optional<Found> next();
  /// Drops what was received, and learns the checksum anew.
  void clear();
  [[nodiscard]] const LdsCounters& counters() const { return counters_; }
  /// Treatment of wrong checksums at present; kLearn: not learned yet.
  [[nodiscard]] LdsChecksum checksum() const { return checksum_; }

 private:
  void drop_byte();
  [[nodiscard]] bool is_number(std::uint8_t byte) const;
  /// Whether a packet with this checksum counts; learns.
  [[nodiscard]] bool accepts(bool intact);

  const LdsFormat& format_;
  LdsChecksum setting_;
  LdsChecksum checksum_;
  int right_ = 0;  // checksums in a row, while learning
  int seen_ = 0;   // packets, while learning
  std::deque<std::uint8_t> buffer_;
  LdsCounters counters_;
};

}  // namespace topogeo::devices
