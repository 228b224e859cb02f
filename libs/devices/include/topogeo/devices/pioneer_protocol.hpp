// Protocol of the ActivMedia, MobileRobots and Adept Pioneers (ARCOS, AROS, P2OS): packets with a
// length and a checksum, in both directions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace topogeo::devices {

/// Numbers of the client commands. Before a connection 0, 1 and 2 are the synchronization.
namespace pioneer_command {
inline constexpr std::uint8_t kPulse = 0;
inline constexpr std::uint8_t kOpen = 1;
inline constexpr std::uint8_t kClose = 2;
inline constexpr std::uint8_t kEnable = 4;                ///< 1: the motors
inline constexpr std::uint8_t kSetAcceleration = 5;       ///< mm/s^2; negative: deceleration
inline constexpr std::uint8_t kSetFastest = 6;            ///< mm/s
inline constexpr std::uint8_t kSetFastestTurn = 10;       ///< degrees/s
inline constexpr std::uint8_t kSpeed = 11;                ///< mm/s, ahead
inline constexpr std::uint8_t kTurn = 21;                 ///< degrees/s, counter-clockwise
inline constexpr std::uint8_t kSetTurnAcceleration = 23;  ///< degrees/s^2; negative: deceleration
inline constexpr std::uint8_t kSonar = 28;                ///< 1: all arrays fire
}  // namespace pioneer_command

/// Command number or type, and what follows it; without header, length and checksum.
struct PioneerPacket {
  std::vector<std::uint8_t> payload;
  bool operator==(const PioneerPacket&) const = default;
};
/// 0xFA 0xFB, the length with the checksum, the payload, and the checksum, the higher byte first.
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const PioneerPacket& packet);
/// The sum of the payload's words, the higher byte first; a last single byte is combined with it by
/// exclusive or.
[[nodiscard]] std::uint16_t pioneer_checksum(std::span<const std::uint8_t> payload);

struct PioneerCounters {
  std::uint64_t noise_bytes = 0;  ///< outside of packets
  std::uint64_t bad_checksum = 0;
  bool operator==(const PioneerCounters&) const = default;
};

/// Finds packets in a stream of bytes that is cut anywhere.
class PioneerReader {
 public:
  void push(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<PioneerPacket> next();
  void clear() { bytes_.clear(); }
  [[nodiscard]] const PioneerCounters& counters() const { return counters_; }

 private:
  std::deque<std::uint8_t> bytes_;
  PioneerCounters counters_;
};

/// A client command; its argument is a whole number of two bytes with a type that is its sign.
struct PioneerOrder {
  std::uint8_t command = 0;
  std::optional<int> value{};  ///< -65,535 to 65,535
  bool operator==(const PioneerOrder&) const = default;
};
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const PioneerOrder& order);
/// Empty for another packet.
[[nodiscard]] std::optional<PioneerOrder> pioneer_order(const PioneerPacket& packet);

struct PioneerEcho {
  std::uint8_t number = 0;  ///< of the sonar
  std::uint16_t range = 0;  ///< its unit depends on the robot
  bool operator==(const PioneerEcho&) const = default;
};

/// The standard information packet of the server (SIP), as far as the driver reads it.
struct PioneerReport {
  bool moves = false;
  std::uint16_t x = 0;  ///< of the position; wraps after 15 bits
  std::uint16_t y = 0;
  std::int16_t heading = 0;    ///< counter-clockwise
  std::int16_t left_mmps = 0;  ///< speeds of the wheels
  std::int16_t right_mmps = 0;
  std::uint8_t battery_dv = 0;  ///< 0.1 V
  std::uint16_t stalls = 0;     ///< of the wheels, and bumpers: see the constants
  std::uint16_t flags = 0;
  std::vector<PioneerEcho> echoes;  ///< new ones
  bool operator==(const PioneerReport&) const = default;
};
inline constexpr unsigned kPioneerLeftStall = 0x0001;
inline constexpr unsigned kPioneerRightStall = 0x0100;
inline constexpr unsigned kPioneerMotors = 0x0001;   ///< flag: they are enabled
inline constexpr unsigned kPioneerStopped = 0x0060;  ///< flags: stop button, E-stall
inline constexpr unsigned kPioneerPositionBits = 15;

/// Empty for another packet, and for one whose length does not fit its number of echoes.
[[nodiscard]] std::optional<PioneerReport> pioneer_report(const PioneerPacket& packet);
/// The packet that the server sends for a report.
[[nodiscard]] PioneerPacket to_packet(const PioneerReport& report);
/// Bumpers of a report: bits 0 to 6 of the first group, 7 to 13 of the second one.
[[nodiscard]] std::uint16_t pioneer_bumpers(const PioneerReport& report);

}  // namespace topogeo::devices
