#include "topogeo/devices/mcp_binary.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

namespace topogeo::devices {
namespace {

// Each occurs twice around a frame.
constexpr std::uint8_t kStart = 0x02;
constexpr std::uint8_t kEnd = 0x03;
constexpr std::size_t kMaxPayload = 255;  // its length is one byte
constexpr unsigned kProofs = 3;           // right checksums, see McpChecksum::kLearn

std::uint8_t exclusive_or(std::span<const std::uint8_t> bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum ^= byte;
  return sum;
}

constexpr std::uint8_t opcode(McpCommand command) {
  return static_cast<std::uint8_t>(command);
}

void append_big_endian(std::uint32_t value, unsigned size, std::vector<std::uint8_t>& bytes) {
  for (unsigned i = size; i-- > 0;) {
    bytes.push_back(static_cast<std::uint8_t>((value >> (8U * i)) & 0xFFU));
  }
}

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  return std::accumulate(
      bytes.begin(), bytes.end(), std::uint32_t{0},
      [](std::uint32_t sum, std::uint8_t byte) { return (sum << 8U) | std::uint32_t{byte}; });
}

constexpr std::array kErrorBits{McpEventKind::kTranslateError, McpEventKind::kTranslateCurrent,
                                McpEventKind::kRotateError,    McpEventKind::kRotateCurrent,
                                McpEventKind::kBatteryHigh,    McpEventKind::kBatteryLow};

std::optional<McpEventKind> event_of_code(std::uint8_t code) {
  switch (code) {
    case opcode(McpCommand::kSync):
      return McpEventKind::kLostSync;
    case opcode(McpCommand::kKill):
      return McpEventKind::kErrorCleared;
    case opcode(McpCommand::kWatchdog):
      return McpEventKind::kWatchdogExpired;
    case opcode(McpCommand::kIndexMask):
      return McpEventKind::kIndex;
    default:
      return std::nullopt;
  }
}

}  // namespace

McpPacket binary_packet(const McpOrder& order) {
  McpPacket packet{};
  packet[0] = opcode(order.command);
  for (unsigned i = 0; i < 4; ++i) {
    packet[1 + i] = static_cast<std::uint8_t>((order.argument >> (24U - 8U * i)) & 0xFFU);
  }
  packet[5] = exclusive_or(std::span(packet).first(5));
  return packet;
}

void append_binary_frame(std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& bytes) {
  if (payload.empty() || payload.size() > kMaxPayload) {
    throw std::invalid_argument("mcp: a payload of " + std::to_string(payload.size()) +
                                " bytes is not in 1..255");
  }
  const auto stuffed = [&bytes](std::uint8_t byte) {
    bytes.push_back(byte);
    if (byte == kStart || byte == kEnd) bytes.push_back(0);
  };
  bytes.insert(bytes.end(), {kStart, kStart});
  stuffed(static_cast<std::uint8_t>(payload.size()));
  std::ranges::for_each(payload, stuffed);
  stuffed(exclusive_or(payload));
  bytes.insert(bytes.end(), {kEnd, kEnd});
}

std::vector<std::uint8_t> binary_payload(const McpReport& report, McpCommand command) {
  std::vector<std::uint8_t> payload{opcode(command)};
  append_big_endian(report.mask, 4, payload);
  for (std::size_t field = 1; field < kMcpFields; ++field) {
    if ((report.mask >> field & 1U) != 0) {
      append_big_endian(report.fields[field], is_wide(field) ? 4 : 2, payload);
    }
  }
  return payload;
}

void McpBinaryDecoder::reset() {
  state_ = State::kSearch;
  marks_ = 0;
  in_garbage_ = false;
}

void McpBinaryDecoder::decode(std::span<const std::uint8_t> bytes,
                              std::vector<McpMessage>& messages) {
  for (const std::uint8_t byte : bytes) take(byte, messages);
}

void McpBinaryDecoder::take(std::uint8_t byte, std::vector<McpMessage>& messages) {
  switch (state_) {
    case State::kSearch:
      return search(byte);
    case State::kLength:
      return take_length(byte);
    case State::kBody:
      return take_body(byte);
    case State::kStuffing:
      return take_stuffing(byte);
    case State::kEnd:
      break;
  }
  if (byte != kEnd) return lost_end(byte);
  if (++marks_ == 2) end_frame(messages);
}

void McpBinaryDecoder::search(std::uint8_t byte) {
  if (byte == kStart) {
    if (++marks_ == 2) state_ = State::kLength;
    return;
  }
  marks_ = 0;
  if (!in_garbage_) ++count_of(drops_, McpDrop::kGarbage);
  in_garbage_ = true;
}

/// Noise may end with start marks, so that more than two precede the length. A 00 after them means
/// that the last of them is the length itself.
void McpBinaryDecoder::take_length(std::uint8_t byte) {
  if (byte == kStart) {
    ++marks_;
    return;
  }
  if (byte != 0) return start_body(byte);
  if (marks_ < 3) return lost_end(byte);
  start_body(kStart);
  state_ = State::kBody;
}

void McpBinaryDecoder::start_body(std::uint8_t length) {
  in_garbage_ = false;
  length_ = length;
  body_.clear();
  stuffed_ = length;
  state_ = length == kEnd ? State::kStuffing : State::kBody;
}

void McpBinaryDecoder::take_body(std::uint8_t byte) {
  body_.push_back(byte);
  stuffed_ = byte;
  state_ = byte == kStart || byte == kEnd ? State::kStuffing : after_byte();
  marks_ = 0;
}

void McpBinaryDecoder::take_stuffing(std::uint8_t byte) {
  marks_ = 0;
  if (byte == 0) {
    state_ = after_byte();
  } else if (stuffed_ == kStart && byte == kStart) {
    ++count_of(drops_, McpDrop::kLostEnd);
    state_ = State::kLength;
    marks_ = 2;
  } else {
    lost_end(byte);
  }
}

McpBinaryDecoder::State McpBinaryDecoder::after_byte() const {
  return body_.size() == length_ + 1 ? State::kEnd : State::kBody;
}

/// Skips to the next start, which this byte may be part of.
void McpBinaryDecoder::lost_end(std::uint8_t byte) {
  ++count_of(drops_, McpDrop::kLostEnd);
  in_garbage_ = true;
  state_ = State::kSearch;
  marks_ = 0;
  search(byte);
}

void McpBinaryDecoder::end_frame(std::vector<McpMessage>& messages) {
  state_ = State::kSearch;
  marks_ = 0;
  const auto payload = std::span<const std::uint8_t>(body_).first(length_);
  if (exclusive_or(payload) == body_.back()) {
    right_checksums_ = std::min(right_checksums_ + 1, kProofs);
  } else if (checksum_ == McpChecksum::kDrop ||
             (checksum_ == McpChecksum::kLearn && right_checksums_ == kProofs)) {
    ++count_of(drops_, McpDrop::kChecksum);
    return;
  } else {
    ++warnings_;
  }
  interpret(payload, messages);
}

void McpBinaryDecoder::interpret(std::span<const std::uint8_t> payload,
                                 std::vector<McpMessage>& messages) {
  const std::uint8_t code = payload.front();
  const auto data = payload.subspan(1);
  if (code == opcode(McpCommand::kReportMask) || code == opcode(McpCommand::kReportOnce)) {
    return interpret_report(data, messages);
  }
  const bool fits = data.size() <= sizeof(std::uint32_t);
  if (fits && code == opcode(McpCommand::kVersion)) {  // a reply to kVersion reports errors
    const std::uint32_t bits = big_endian(data);
    for (std::size_t i = 0; i < kErrorBits.size(); ++i) {
      if ((bits >> i & 1U) != 0) messages.emplace_back(McpEvent{kErrorBits.at(i), 0});
    }
  } else if (const auto event = event_of_code(code); fits && event) {
    messages.emplace_back(McpEvent{*event, big_endian(data)});
  } else if (fits && is_query(static_cast<McpCommand>(code))) {
    messages.emplace_back(McpAnswer{static_cast<McpCommand>(code), big_endian(data)});
  } else {
    ++count_of(drops_, McpDrop::kUnknownOpcode);
  }
}

void McpBinaryDecoder::interpret_report(std::span<const std::uint8_t> data,
                                        std::vector<McpMessage>& messages) {
  constexpr std::size_t kMaskBytes = 4;
  McpReport report;
  if (data.size() >= kMaskBytes) report.mask = big_endian(data.first(kMaskBytes));
  std::size_t at = kMaskBytes;
  for (std::size_t field = 1; field < kMcpFields; ++field) {
    if ((report.mask >> field & 1U) == 0) continue;
    const std::size_t size = is_wide(field) ? 4 : 2;
    if (at + size <= data.size()) report.fields[field] = big_endian(data.subspan(at, size));
    at += size;
  }
  if (at != data.size()) {
    ++count_of(drops_, McpDrop::kBadReport);
    return;
  }
  if (report.has(McpField::kMask)) report.fields[0] = report.mask;
  messages.emplace_back(report);
}

}  // namespace topogeo::devices
