// Serial protocol of VESC motor controllers: packets with a length, a CRC-16 and an end byte; words
// have the higher byte first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

/// Numbers of the commands, which their answers repeat.
namespace vesc_command {
inline constexpr std::uint8_t kSetRpm = 8;  ///< electrical turns a minute
/// Passes the rest, a command, on to the controller of this number on the CAN bus.
inline constexpr std::uint8_t kForward = 34;
/// Asks for the values whose bits are set in a mask of four bytes, which the answer repeats.
inline constexpr std::uint8_t kGetSelected = 50;
}  // namespace vesc_command

struct VescPacket {
  std::vector<std::uint8_t> payload;  ///< 1 to 255 bytes
  bool operator==(const VescPacket&) const = default;
};
/// 2, the length, the payload, its CRC-16/XMODEM, 3.
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const VescPacket& packet);

struct VescCounters {
  std::uint64_t noise_bytes = 0;  ///< outside of packets
  std::uint64_t bad_checksum = 0;
  bool operator==(const VescCounters&) const = default;
};

/// Finds packets in a stream of bytes that is cut anywhere; those of more than 255 bytes are noise.
class VescReader {
 public:
  void push(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<VescPacket> next();
  void clear() { bytes_.clear(); }
  [[nodiscard]] const VescCounters& counters() const { return counters_; }

 private:
  std::deque<std::uint8_t> bytes_;
  VescCounters counters_;
};

/// The answer to vesc_get_values().
struct VescValues {
  std::int16_t battery_dv = 0;  ///< 0.1 V
  std::int32_t tachometer = 0;  ///< six steps an electrical turn; wraps
  std::uint8_t fault = 0;       ///< 0: none
  std::uint8_t controller = 0;  ///< its number on the CAN bus
  bool operator==(const VescValues&) const = default;
};
/// Empty for another packet, and for other values.
[[nodiscard]] std::optional<VescValues> vesc_values(const VescPacket& packet);
[[nodiscard]] VescPacket to_packet(const VescValues& values);

[[nodiscard]] VescPacket vesc_get_values();
[[nodiscard]] VescPacket vesc_set_rpm(std::int32_t erpm);
[[nodiscard]] VescPacket vesc_forward(std::uint8_t controller, const VescPacket& packet);
/// Electrical turns a minute of kSetRpm; empty for another packet.
[[nodiscard]] std::optional<std::int32_t> vesc_rpm(const VescPacket& packet);

}  // namespace topogeo::devices
