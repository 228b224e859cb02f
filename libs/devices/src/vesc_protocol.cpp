#include "topogeo/devices/vesc_protocol.hpp"

#include <string_view>

#include "topogeo/devices/text_base_protocol.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kVescStart = 2;
constexpr std::uint8_t kVescEnd = 3;
constexpr std::size_t kBeforeVescPayload_bytes = 2;
constexpr std::size_t kBehindVescPayload_bytes = 3;
constexpr std::size_t kVescRpm_bytes = 5;

/// Input voltage, tachometer, fault, number of the controller.
constexpr std::int32_t kVescMask = 1 << 8 | 1 << 13 | 1 << 15 | 1 << 17;
// Places in a request and its answer.
constexpr std::size_t kMaskAt = 1;
constexpr std::size_t kVoltageAt = 5;
constexpr std::size_t kTachometerAt = 7;
constexpr std::size_t kFaultAt = 11;
constexpr std::size_t kControllerAt = 12;
constexpr std::size_t kVescValues_bytes = 13;

std::uint16_t vesc_crc(const std::vector<std::uint8_t>& payload) {
  return text_base_crc({reinterpret_cast<const char*>(payload.data()), payload.size()});
}

std::int32_t big_word_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word = word << 8U | bytes[at + i];
  return static_cast<std::int32_t>(word);
}

void set_big_word(std::vector<std::uint8_t>& bytes, std::size_t at, std::int32_t word) {
  constexpr unsigned kByteBits = 8;
  for (std::size_t i = 4; i-- > 0;) {
    bytes[at + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(word) & 0xFFU);
    word >>= kByteBits;
  }
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const VescPacket& packet) {
  std::vector<std::uint8_t> bytes;
  const std::size_t size = packet.payload.size();
  bytes.reserve(kBeforeVescPayload_bytes + size + kBehindVescPayload_bytes);
  bytes.push_back(kVescStart);
  bytes.push_back(static_cast<std::uint8_t>(size));
  bytes.insert(bytes.end(), packet.payload.begin(), packet.payload.end());
  const std::uint16_t crc = vesc_crc(packet.payload);
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  bytes.push_back(kVescEnd);
  return bytes;
}

void VescReader::push(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<VescPacket> VescReader::next() {
  while (!bytes_.empty()) {
    if (bytes_[0] != kVescStart || (bytes_.size() > 1 && bytes_[1] == 0)) {
      ++counters_.noise_bytes;
      bytes_.pop_front();
      continue;
    }
    if (bytes_.size() < kBeforeVescPayload_bytes) return std::nullopt;
    const std::size_t size = kBeforeVescPayload_bytes + bytes_[1] + kBehindVescPayload_bytes;
    if (bytes_.size() < size) return std::nullopt;
    VescPacket packet;
    const auto begin = bytes_.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(size);
    packet.payload.assign(begin + kBeforeVescPayload_bytes, end - kBehindVescPayload_bytes);
    const auto crc = static_cast<std::uint16_t>(bytes_[size - 3] << 8 | bytes_[size - 2]);
    if (crc != vesc_crc(packet.payload) || bytes_[size - 1] != kVescEnd) {
      // A packet that was cut may contain the start of the next one.
      ++counters_.bad_checksum;
      bytes_.pop_front();
      continue;
    }
    bytes_.erase(begin, end);
    return packet;
  }
  return std::nullopt;
}

std::optional<VescValues> vesc_values(const VescPacket& packet) {
  const std::vector<std::uint8_t>& bytes = packet.payload;
  if (bytes[0] != vesc_command::kGetSelected || bytes.size() != kVescValues_bytes) {
    return std::nullopt;
  }
  if (big_word_at(bytes, kMaskAt) != kVescMask) return std::nullopt;
  VescValues values;
  values.battery_dv = static_cast<std::int16_t>(bytes[kVoltageAt] << 8 | bytes[kVoltageAt + 1]);
  values.tachometer = big_word_at(bytes, kTachometerAt);
  values.fault = bytes[kFaultAt];
  values.controller = bytes[kControllerAt];
  return values;
}

VescPacket to_packet(const VescValues& values) {
  std::vector<std::uint8_t> bytes(kVescValues_bytes, 0);
  bytes[0] = vesc_command::kGetSelected;
  set_big_word(bytes, kMaskAt, kVescMask);
  const auto voltage = static_cast<std::uint16_t>(values.battery_dv);
  bytes[kVoltageAt] = static_cast<std::uint8_t>(voltage >> 8);
  bytes[kVoltageAt + 1] = static_cast<std::uint8_t>(voltage & 0xFFU);
  set_big_word(bytes, kTachometerAt, values.tachometer);
  bytes[kFaultAt] = values.fault;
  bytes[kControllerAt] = values.controller;
  return {bytes};
}

VescPacket vesc_get_values() {
  VescPacket packet{std::vector<std::uint8_t>(kVoltageAt, 0)};
  packet.payload[0] = vesc_command::kGetSelected;
  set_big_word(packet.payload, kMaskAt, kVescMask);
  return packet;
}

VescPacket vesc_set_rpm(std::int32_t erpm) {
  VescPacket packet{std::vector<std::uint8_t>(kVescRpm_bytes, 0)};
  packet.payload[0] = vesc_command::kSetRpm;
  set_big_word(packet.payload, 1, erpm);
  return packet;
}

VescPacket vesc_forward(std::uint8_t controller, const VescPacket& packet) {
  VescPacket forward;
  forward.payload.reserve(packet.payload.size() + 2);
  forward.payload.push_back(vesc_command::kForward);
  forward.payload.push_back(controller);
  for (const std::uint8_t byte : packet.payload) forward.payload.push_back(byte);
  return forward;
}

std::optional<std::int32_t> vesc_rpm(const VescPacket& packet) {
  if (packet.payload.size() != kVescRpm_bytes) return std::nullopt;
  if (packet.payload[0] != vesc_command::kSetRpm) return std::nullopt;
  return big_word_at(packet.payload, 1);
}

}  // namespace topogeo::devices
