// The binary dialect of the MCP ("direct mode"). Host to base: packets of six bytes without a start
// mark, so that a base that lost one needs zeros to find the next. Base to host: frames 02 02
// length payload checksum 03 03, with a 00 after every 02 and 03 between the marks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

using McpPacket = std::array<std::uint8_t, 6>;
/// Contents: the opcode, the argument with the most significant byte first, the XOR of these five.
McpPacket binary_packet(const McpOrder& order);
/// This many zeros in succession make a base search for the start of a packet again.
inline constexpr std::size_t kMcpSyncZeros = 7;

/// Appends the frame of a payload (opcode and data). Throws std::invalid_argument unless it has
/// 1 to 255 bytes.
void append_binary_frame(std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& bytes);
/// The payload of a report; `opcode` is kReportMask for a periodic one, kReportOnce for a single.
std::vector<std::uint8_t> binary_payload(const McpReport& report, McpCommand opcode);

/// Treatment of frames with a wrong checksum. The rule of the checksum is known from a simulator
/// only.
enum class McpChecksum : std::uint8_t {
  kWarn,   ///< accept the frame
  kDrop,   ///< drop the frame
  kLearn,  ///< drop the frame once three frames of this base had the right one
};

/// Decodes messages from the bytes of a base, cut anywhere.
class McpBinaryDecoder {
 public:
  explicit McpBinaryDecoder(McpChecksum checksum = McpChecksum::kLearn) : checksum_(checksum) {}

  /// Appends the messages that `bytes` complete.
  void decode(std::span<const std::uint8_t> bytes, std::vector<McpMessage>& messages);
  /// Forgets the incomplete frame.
  void reset();

  [[nodiscard]] const McpDrops& drops() const { return drops_; }
  /// Frames accepted with a wrong checksum.
  [[nodiscard]] std::uint64_t checksum_warnings() const { return warnings_; }

 private:
  enum class State : std::uint8_t { kSearch, kLength, kBody, kStuffing, kEnd };

  void take(std::uint8_t byte, std::vector<McpMessage>& messages);
  void search(std::uint8_t byte);
  void take_length(std::uint8_t byte);
  void take_body(std::uint8_t byte);
  void take_stuffing(std::uint8_t byte);
  void start_body(std::uint8_t length);
  void lost_end(std::uint8_t byte);
  [[nodiscard]] State after_byte() const;
  void end_frame(std::vector<McpMessage>& messages);
  void interpret(std::span<const std::uint8_t> payload, std::vector<McpMessage>& messages);
  void interpret_report(std::span<const std::uint8_t> payload, std::vector<McpMessage>& messages);

  McpChecksum checksum_;
  State state_ = State::kSearch;
  bool in_garbage_ = false;
  unsigned marks_ = 0;  // successive 02 in kSearch and kLength, else successive 03
  std::size_t length_ = 0;
  std::uint8_t stuffed_ = 0;          // the byte that a 00 must follow
  std::vector<std::uint8_t> body_{};  // payload and checksum
  unsigned right_checksums_ = 0;
  std::uint64_t warnings_ = 0;
  McpDrops drops_{};
};

}  // namespace topogeo::devices
