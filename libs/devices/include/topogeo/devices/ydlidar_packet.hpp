// Packets of YDLIDAR lasers (X2, X4, G4, TG series).
//
// Sources: Shenzhen EAI Technology (YDLIDAR), "X2 Development Manual", "G4 Development Manual",
// "YDLidar-SDK Communication Protocol". A packet is 0xAA 0x55, its kind, the number of samples, the
// angles of the first and the last, the XOR of all other words, and two bytes for each sample. The
// first packet of a turn has one sample and, on most models, the frequency of the turns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

struct YdPacket {
  bool starts_turn = false;
  std::uint8_t turns_dhz =
      0;  ///< tenths of a turn a second, of a packet that starts a turn; 0: none
  std::uint16_t first_q6 = 0;  ///< degrees times 64, clockwise
  std::uint16_t last_q6 = 0;   ///< of the last sample; the others lie between at equal steps
  std::vector<std::uint16_t>
      samples;  ///< quarters of a millimetre, or millimetres of a TG; 0: none
  bool operator==(const YdPacket&) const = default;

  /// Angle from the first sample to the last, degrees times 64.
  [[nodiscard]] unsigned span_q6() const;
};
inline constexpr unsigned kYdTurnQ6 = 360 * 64;

/// `packet` has 1 to 255 samples.
[[nodiscard]] std::vector<std::uint8_t> yd_bytes(const YdPacket& packet);

/// Correction of the angle of a laser that measures by triangulation, degrees, clockwise: its
/// emitter lies beside the receiver. 0 for a distance of 0.
[[nodiscard]] double yd_correction_deg(double distance_mm);
/// The same for a point at infinity.
[[nodiscard]] double yd_far_correction_deg();

namespace yd_command {
inline constexpr std::uint8_t kStop = 0x65;
inline constexpr std::uint8_t kScan = 0x60;
inline constexpr std::uint8_t kGetInfo = 0x90;
inline constexpr std::uint8_t kGetHealth = 0x91;
}  // namespace yd_command
[[nodiscard]] std::vector<std::uint8_t> yd_request(std::uint8_t command);

/// Counts of dropped bytes and packets.
struct YdCounters {
  std::uint64_t noise_bytes = 0;   ///< outside of packets and answers
  std::uint64_t bad_checksum = 0;  ///< packets, also apparent ones
  std::uint64_t alone = 0;         ///< packets that no other header follows at once
  std::uint64_t implausible = 0;   ///< packets with angles that no laser has
  bool operator==(const YdCounters&) const = default;
};

/// Answers to requests. Their descriptor is that of a RPLIDAR: 0xA5 0x5A, length and kind, type.
namespace yd_answer {
inline constexpr std::uint8_t kInfo = 0x04;
inline constexpr std::uint8_t kHealth = 0x06;
inline constexpr std::uint8_t kScan = 0x81;
}  // namespace yd_answer
inline constexpr std::size_t kYdInfo_bytes = 20;
inline constexpr std::size_t kYdHealth_bytes = 3;

/// Finds packets and answers in a stream of bytes that is cut anywhere. A packet counts if the
/// header of another one or of an answer follows it at once: the checksum alone lets one wrong
/// packet of 65,536 pass.
class YdDecoder {
 public:
  struct Found {
    std::optional<YdPacket> packet;  ///< otherwise an answer
    std::uint8_t answer_type = 0;
    std::vector<std::uint8_t> answer;
    std::size_t bytes_since = 0;  ///< that were received after it
  };

  void push(std::span<const std::uint8_t> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  /// The next packet or answer; empty: more bytes are needed.
  [[nodiscard]] std::optional<Found> next();
  void clear() { buffer_.clear(); }
  [[nodiscard]] const YdCounters& counters() const { return counters_; }

 private:
  enum class Need : std::uint8_t { kMore, kNoise, kFound };
  [[nodiscard]] Need take_packet(Found& found);
  [[nodiscard]] Need take_answer(Found& found);
  [[nodiscard]] std::vector<std::uint8_t> front(std::size_t count) const;
  void drop(std::size_t count);

  std::deque<std::uint8_t> buffer_;
  YdCounters counters_;
};

}  // namespace topogeo::devices
