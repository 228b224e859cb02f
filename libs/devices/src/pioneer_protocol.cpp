#include "topogeo/devices/pioneer_protocol.hpp"

#include <algorithm>
#include <cstdlib>

#include "topogeo/devices/little_endian.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kPioneerHeader1 = 0xFA;
constexpr std::uint8_t kPioneerHeader2 = 0xFB;
constexpr std::size_t kPioneerHeader_bytes = 3;
constexpr std::size_t kPioneerChecksum_bytes = 2;
/// Length that a packet states: a command without an argument, and the largest one.
constexpr std::uint8_t kShortestLength = 3;
constexpr std::uint8_t kLongestLength = 249;

constexpr std::uint8_t kPositiveNumber = 0x3B;
constexpr std::uint8_t kNegativeNumber = 0x1B;
constexpr std::size_t kOrderWithNumber_bytes = 4;

constexpr std::uint8_t kStandingType = 0x32;
constexpr std::uint8_t kMovingType = 0x33;
constexpr std::size_t kBeforeEchoes_bytes = 20;
constexpr std::size_t kEcho_bytes = 3;
/// Gripper or timer, analog and digital inputs and outputs; newer firmware sends more.
constexpr std::size_t kBehindEchoes_bytes = 5;

/// Whether `bytes` begin as a packet does, as far as they go.
bool begins_pioneer_packet(const std::deque<std::uint8_t>& bytes) {
  if (bytes[0] != kPioneerHeader1) return false;
  if (bytes.size() > 1 && bytes[1] != kPioneerHeader2) return false;
  return bytes.size() <= 2 || (bytes[2] >= kShortestLength && bytes[2] <= kLongestLength);
}

std::int16_t signed_word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::int16_t>(word_at(bytes, at));
}

}  // namespace

std::uint16_t pioneer_checksum(std::span<const std::uint8_t> payload) {
  unsigned sum = 0;
  for (; payload.size() > 1; payload = payload.subspan(2)) {
    sum += static_cast<unsigned>(payload[0] << 8 | payload[1]);
  }
  if (!payload.empty()) sum ^= payload[0];
  return static_cast<std::uint16_t>(sum);
}

std::vector<std::uint8_t> to_bytes(const PioneerPacket& packet) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(kPioneerHeader_bytes + packet.payload.size() + kPioneerChecksum_bytes);
  bytes.push_back(kPioneerHeader1);
  bytes.push_back(kPioneerHeader2);
  bytes.push_back(static_cast<std::uint8_t>(packet.payload.size() + kPioneerChecksum_bytes));
  bytes.insert(bytes.end(), packet.payload.begin(), packet.payload.end());
  const std::uint16_t sum = pioneer_checksum(packet.payload);
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  bytes.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
  return bytes;
}

void PioneerReader::push(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<PioneerPacket> PioneerReader::next() {
  while (!bytes_.empty()) {
    if (!begins_pioneer_packet(bytes_)) {
      ++counters_.noise_bytes;
      bytes_.pop_front();
      continue;
    }
    if (bytes_.size() < kPioneerHeader_bytes) return std::nullopt;
    const std::size_t size = kPioneerHeader_bytes + bytes_[2];
    if (bytes_.size() < size) return std::nullopt;
    PioneerPacket packet;
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(size);
    packet.payload.assign(bytes_.begin() + kPioneerHeader_bytes, end - kPioneerChecksum_bytes);
    const auto sum = static_cast<std::uint16_t>(bytes_[size - 2] << 8 | bytes_[size - 1]);
    if (sum != pioneer_checksum(packet.payload)) {
      // A packet that was cut may contain the start of the next one.
      ++counters_.bad_checksum;
      bytes_.pop_front();
      continue;
    }
    bytes_.erase(bytes_.begin(), end);
    return packet;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> to_bytes(const PioneerOrder& order) {
  PioneerPacket packet{{order.command}};
  if (order.value) {
    packet.payload.push_back(*order.value < 0 ? kNegativeNumber : kPositiveNumber);
    put_word(packet.payload, static_cast<unsigned>(std::abs(*order.value)));
  }
  return to_bytes(packet);
}

std::optional<PioneerOrder> pioneer_order(const PioneerPacket& packet) {
  const std::vector<std::uint8_t>& bytes = packet.payload;
  std::optional<PioneerOrder> order;
  if (bytes.size() == 1) order.emplace().command = bytes[0];
  if (bytes.size() != kOrderWithNumber_bytes) return order;
  if (bytes[1] != kPositiveNumber && bytes[1] != kNegativeNumber) return order;
  const int value = word_at(bytes, 2);
  order.emplace().command = bytes[0];
  order->value = bytes[1] == kPositiveNumber ? value : -value;
  return order;
}

std::optional<PioneerReport> pioneer_report(const PioneerPacket& packet) {
  const std::span<const std::uint8_t> bytes = packet.payload;
  if (bytes[0] != kStandingType && bytes[0] != kMovingType) return std::nullopt;
  if (bytes.size() < kBeforeEchoes_bytes) return std::nullopt;
  const std::size_t echoes = bytes[kBeforeEchoes_bytes - 1];
  if (bytes.size() < kBeforeEchoes_bytes + kEcho_bytes * echoes) return std::nullopt;
  PioneerReport report{.moves = bytes[0] == kMovingType,
                       .x = word_at(bytes, 1),
                       .y = word_at(bytes, 3),
                       .heading = signed_word_at(bytes, 5),
                       .left_mmps = signed_word_at(bytes, 7),
                       .right_mmps = signed_word_at(bytes, 9),
                       .battery_dv = bytes[11],
                       .stalls = word_at(bytes, 12),
                       .flags = word_at(bytes, 16),
                       .echoes = {}};
  for (std::size_t i = 0; i < echoes; ++i) {
    const std::size_t at = kBeforeEchoes_bytes + kEcho_bytes * i;
    report.echoes.push_back({bytes[at], word_at(bytes, at + 1)});
  }
  return report;
}

PioneerPacket to_packet(const PioneerReport& report) {
  constexpr unsigned kSetpoint = 0;
  constexpr std::uint8_t kNoCompass = 0;
  std::vector<std::uint8_t> bytes{report.moves ? kMovingType : kStandingType};
  put_word(bytes, report.x);
  put_word(bytes, report.y);
  for (const std::int16_t number : {report.heading, report.left_mmps, report.right_mmps}) {
    put_word(bytes, static_cast<std::uint16_t>(number));
  }
  bytes.push_back(report.battery_dv);
  put_word(bytes, report.stalls);
  put_word(bytes, kSetpoint);
  put_word(bytes, report.flags);
  bytes.push_back(kNoCompass);
  bytes.push_back(static_cast<std::uint8_t>(report.echoes.size()));
  for (const PioneerEcho& echo : report.echoes) {
    bytes.push_back(echo.number);
    put_word(bytes, echo.range);
  }
  bytes.insert(bytes.end(), kBehindEchoes_bytes, 0);
  return {bytes};
}

std::uint16_t pioneer_bumpers(const PioneerReport& report) {
  constexpr unsigned kGroup = 0x7F;
  constexpr unsigned kGroupBits = 7;
  const unsigned first = report.stalls >> 1 & kGroup;
  const unsigned second = report.stalls >> 9 & kGroup;
  return static_cast<std::uint16_t>(first | second << kGroupBits);
}

}  // namespace topogeo::devices
