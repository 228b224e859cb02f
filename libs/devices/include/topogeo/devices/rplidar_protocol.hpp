// Requests and answers of Slamtec RPLIDAR lasers.
//
// Source: Slamtec, "RPLIDAR Low Cost 360 Degree Laser Range Scanner: Interface Protocol and
// Application Notes" (A-series and S-series). A request is 0xA5, a command and, if it has a
// payload, its length, the payload and the XOR of all bytes. An answer begins with a descriptor of
// seven bytes: 0xA5 0x5A, length and kind of the data, its type. The samples of a scan follow one
// descriptor without end.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace topogeo::devices {

namespace rp_command {
inline constexpr std::uint8_t kStop = 0x25;
inline constexpr std::uint8_t kReset = 0x40;
inline constexpr std::uint8_t kScan = 0x20;
inline constexpr std::uint8_t kExpressScan = 0x82;
inline constexpr std::uint8_t kGetInfo = 0x50;
inline constexpr std::uint8_t kGetHealth = 0x52;
inline constexpr std::uint8_t kGetSampleRate = 0x59;
inline constexpr std::uint8_t kMotorSpeed = 0xA8;  ///< turns a minute, of S and C series
inline constexpr std::uint8_t kMotorPwm = 0xF0;    ///< of the A2 and A3 with their adapter
}  // namespace rp_command

namespace rp_answer {
inline constexpr std::uint8_t kInfo = 0x04;
inline constexpr std::uint8_t kHealth = 0x06;
inline constexpr std::uint8_t kSampleRate = 0x15;
inline constexpr std::uint8_t kScan = 0x81;
inline constexpr std::uint8_t kExpress = 0x82;
inline constexpr std::uint8_t kDense = 0x85;
}  // namespace rp_answer

/// `payload` may be empty.
[[nodiscard]] std::vector<std::uint8_t> rp_request(std::uint8_t command,
                                                   std::span<const std::uint8_t> payload = {});
/// The request of an express scan in a working mode; 0: the first one, of all lasers.
[[nodiscard]] std::vector<std::uint8_t> rp_express_request(std::uint8_t mode);
[[nodiscard]] std::vector<std::uint8_t> rp_motor_request(std::uint8_t command, std::uint16_t value);

struct RpDescriptor {
  std::uint32_t length = 0;  ///< of one answer, bytes
  bool repeats = false;      ///< answers follow until the next request
  std::uint8_t type = 0;
  bool operator==(const RpDescriptor&) const = default;
};
inline constexpr std::size_t kRpDescriptor_bytes = 7;
[[nodiscard]] std::vector<std::uint8_t> rp_bytes(const RpDescriptor& descriptor);
/// Empty if the bytes are no descriptor. `bytes` has kRpDescriptor_bytes.
[[nodiscard]] std::optional<RpDescriptor> rp_descriptor(std::span<const std::uint8_t> bytes);

struct RpInfo {
  std::uint8_t model = 0;  ///< series in the upper four bits
  std::uint8_t firmware_major = 0;
  std::uint8_t firmware_minor = 0;
  std::uint8_t hardware = 0;
};
inline constexpr std::size_t kRpInfo_bytes = 20;
[[nodiscard]] RpInfo rp_info(std::span<const std::uint8_t> data);
/// "model 24, firmware 1.29, hardware 7".
[[nodiscard]] std::string text_of(const RpInfo& info);

/// One sample of a standard scan.
struct RpSample {
  bool starts_turn = false;
  std::uint8_t quality = 0;       ///< 0 to 63
  std::uint16_t angle_q6 = 0;     ///< degrees times 64, clockwise
  std::uint16_t distance_q2 = 0;  ///< millimetres times 4; 0: no return
  bool operator==(const RpSample&) const = default;
};
inline constexpr std::size_t kRpSample_bytes = 5;
[[nodiscard]] std::array<std::uint8_t, kRpSample_bytes> rp_bytes(const RpSample& sample);
/// Empty if the check bits are wrong. `bytes` has kRpSample_bytes.
[[nodiscard]] std::optional<RpSample> rp_sample(std::span<const std::uint8_t> bytes);

/// A packet of an express scan or a dense one. Its angles need the start of the next packet.
struct RpPacket {
  struct Point {
    double distance_mm = 0.0;  ///< 0: no return
    int compensation_q3 = 0;   ///< degrees times 8, 0 to 63 as sent
    bool operator==(const Point&) const = default;
  };
  std::uint16_t start_q6 = 0;  ///< degrees times 64, clockwise
  bool starts = false;         ///< first packet after the request
  std::vector<Point> points;   ///< 32 of an express packet, 40 of a dense one
  bool operator==(const RpPacket&) const = default;
};
inline constexpr std::size_t kRpPacket_bytes = 84;
inline constexpr std::size_t kRpExpressPoints = 32;
inline constexpr std::size_t kRpDensePoints = 40;
inline constexpr unsigned kRpTurnQ6 = 360 * 64;
/// `type` is kExpress or kDense; the packet has the number of points of that type.
[[nodiscard]] std::vector<std::uint8_t> rp_bytes(const RpPacket& packet, std::uint8_t type);
/// Empty if the marks or the checksum are wrong. `bytes` has kRpPacket_bytes.
[[nodiscard]] std::optional<RpPacket> rp_packet(std::span<const std::uint8_t> bytes,
                                                std::uint8_t type);

/// Angle of the point `k` of a packet, degrees, clockwise: the points lie at equal steps from its
/// start to that of the next packet, less their compensation. The Application Notes call the top
/// bit of the compensation its sign, the maker's own driver reads it as part of the number:
/// `compensation_signed`.
[[nodiscard]] double rp_angle_deg(const RpPacket& packet, std::uint16_t next_start_q6,
                                  std::size_t k, bool compensation_signed);

}  // namespace topogeo::devices
