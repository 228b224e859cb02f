#include "topogeo/devices/ldrobot_packet.hpp"

#include <algorithm>

#include "topogeo/devices/little_endian.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kLdHeader = 0x54;
/// Version 1 in the upper three bits, twelve measurements in the lower five.
constexpr std::uint8_t kLdVersionLength = 0x2C;
constexpr std::uint8_t kLdPolynomial = 0x4D;
/// The makers state 5 to 13 turns a second.
constexpr std::uint16_t kSlowest_deg_s = 360;
constexpr std::uint16_t kFastest_deg_s = 30 * 360;
/// Twelve points of a laser that turns that fast.
constexpr unsigned kWidestCdeg = 3000;

constexpr std::array<std::uint8_t, 256> ld_crc_table() {
  std::array<std::uint8_t, 256> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned crc = i;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x80U) != 0 ? (crc << 1 ^ kLdPolynomial) & 0xFFU : crc << 1 & 0xFFU;
    }
    table[i] = static_cast<std::uint8_t>(crc);
  }
  return table;
}

LdPacket packet_of(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kPointsAt = 6;
  constexpr std::size_t kPoint_bytes = 3;
  constexpr std::size_t kEndAt = kPointsAt + kLdPoints * kPoint_bytes;
  LdPacket packet;
  packet.speed_deg_s = word_at(bytes, 2);
  packet.start_cdeg = word_at(bytes, 4);
  for (std::size_t i = 0; i < kLdPoints; ++i) {
    const std::size_t at = kPointsAt + i * kPoint_bytes;
    packet.points[i] = {word_at(bytes, at), bytes[at + 2]};
  }
  packet.end_cdeg = word_at(bytes, kEndAt);
  packet.time_ms = word_at(bytes, kEndAt + 2);
  return packet;
}

bool is_possible(const LdPacket& packet) {
  return packet.start_cdeg < kLdTurnCdeg && packet.end_cdeg < kLdTurnCdeg &&
         packet.time_ms <= kLdTimeWrap_ms && packet.speed_deg_s >= kSlowest_deg_s &&
         packet.speed_deg_s <= kFastest_deg_s && packet.span_cdeg() > 0 &&
         packet.span_cdeg() <= kWidestCdeg;
}

}  // namespace

std::uint8_t ld_crc(std::span<const std::uint8_t> bytes) {
  static constexpr std::array<std::uint8_t, 256> kTable = ld_crc_table();
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : bytes) crc = kTable[crc ^ byte];
  return crc;
}

std::vector<std::uint8_t> ld_bytes(const LdPacket& packet) {
  std::vector<std::uint8_t> bytes{kLdHeader, kLdVersionLength};
  bytes.reserve(kLdPacket_bytes);
  put_word(bytes, packet.speed_deg_s);
  put_word(bytes, packet.start_cdeg);
  for (const LdPoint& point : packet.points) {
    put_word(bytes, point.distance_mm);
    bytes.push_back(point.intensity);
  }
  put_word(bytes, packet.end_cdeg);
  put_word(bytes, packet.time_ms);
  bytes.push_back(ld_crc(bytes));
  return bytes;
}

std::optional<LdDecoder::Found> LdDecoder::next() {
  while (!buffer_.empty()) {
    if (buffer_[0] == kLdHeader && buffer_.size() == 1) return std::nullopt;
    if (buffer_[0] != kLdHeader || buffer_[1] != kLdVersionLength) {
      buffer_.pop_front();
      ++counters_.noise_bytes;
      continue;
    }
    if (buffer_.size() < kLdPacket_bytes) return std::nullopt;
    std::array<std::uint8_t, kLdPacket_bytes> bytes{};
    std::copy_n(buffer_.begin(), bytes.size(), bytes.begin());
    const std::span<const std::uint8_t> all(bytes);
    const LdPacket packet = packet_of(all);
    const bool intact = ld_crc(all.first(kLdPacket_bytes - 1)) == bytes.back();
    if (!intact || !is_possible(packet)) {
      // The header may have been a measurement: the packet may begin within these bytes.
      ++(intact ? counters_.implausible : counters_.bad_checksum);
      buffer_.pop_front();
      ++counters_.noise_bytes;
      continue;
    }
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(kLdPacket_bytes));
    return Found{packet, buffer_.size()};
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
