#include "topogeo/devices/rplidar_protocol.hpp"

#include <cmath>

#include "topogeo/devices/little_endian.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kRpStart = 0xA5;
constexpr std::uint8_t kRpAnswerStart = 0x5A;
constexpr std::uint32_t kLengthMask = 0x3FFF'FFFF;
constexpr std::uint8_t kFirstMark = 0xA0;
constexpr std::uint8_t kSecondMark = 0x50;
constexpr std::size_t kPayloadAt = 2;  // after the marks: what the checksum covers
constexpr std::size_t kCabinsAt = 4;

std::uint8_t xor_of(std::span<const std::uint8_t> bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum ^= byte;
  return sum;
}

void take_express_cabins(std::span<const std::uint8_t> bytes, RpPacket& packet) {
  constexpr std::size_t kCabin_bytes = 5;
  for (std::size_t at = kCabinsAt; at + kCabin_bytes <= bytes.size(); at += kCabin_bytes) {
    const unsigned first = word_at(bytes, at);
    const unsigned second = word_at(bytes, at + 2);
    const unsigned low = bytes[at + 4];
    packet.points.push_back(
        {static_cast<double>(first >> 2), static_cast<int>((first & 3U) << 4 | (low & 0xFU))});
    packet.points.push_back(
        {static_cast<double>(second >> 2), static_cast<int>((second & 3U) << 4 | low >> 4)});
  }
}

void put_express_cabins(const RpPacket& packet, std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 0; i + 1 < packet.points.size(); i += 2) {
    const auto first = static_cast<unsigned>(packet.points[i].compensation_q3);
    const auto second = static_cast<unsigned>(packet.points[i + 1].compensation_q3);
    put_word(bytes, static_cast<unsigned>(packet.points[i].distance_mm) << 2 | first >> 4);
    put_word(bytes, static_cast<unsigned>(packet.points[i + 1].distance_mm) << 2 | second >> 4);
    bytes.push_back(static_cast<std::uint8_t>((second & 0xFU) << 4 | (first & 0xFU)));
  }
}

}  // namespace

std::vector<std::uint8_t> rp_request(std::uint8_t command, std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes{kRpStart, command};
  if (payload.empty()) return bytes;
  bytes.push_back(static_cast<std::uint8_t>(payload.size()));
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  bytes.push_back(xor_of(bytes));
  return bytes;
}

std::vector<std::uint8_t> rp_express_request(std::uint8_t mode) {
  const std::array<std::uint8_t, 5> payload{mode, 0, 0, 0, 0};
  return rp_request(rp_command::kExpressScan, payload);
}

std::vector<std::uint8_t> rp_motor_request(std::uint8_t command, std::uint16_t value) {
  const std::array<std::uint8_t, 2> payload{static_cast<std::uint8_t>(value & 0xFFU),
                                            static_cast<std::uint8_t>(value >> 8)};
  return rp_request(command, payload);
}

std::vector<std::uint8_t> rp_bytes(const RpDescriptor& descriptor) {
  std::vector<std::uint8_t> bytes{kRpStart, kRpAnswerStart};
  const std::uint32_t word = descriptor.length | (descriptor.repeats ? 1U << 30 : 0U);
  put_word(bytes, word & 0xFFFFU);
  put_word(bytes, word >> 16);
  bytes.push_back(descriptor.type);
  return bytes;
}

std::optional<RpDescriptor> rp_descriptor(std::span<const std::uint8_t> bytes) {
  if (bytes[0] != kRpStart || bytes[1] != kRpAnswerStart) return std::nullopt;
  const std::uint32_t word = word_at(bytes, 2) | static_cast<std::uint32_t>(word_at(bytes, 4))
                                                     << 16;
  return RpDescriptor{word & kLengthMask, word >> 30 != 0, bytes[6]};
}

RpInfo rp_info(std::span<const std::uint8_t> data) {
  return {data[0], data[2], data[1], data[3]};
}

std::string text_of(const RpInfo& info) {
  return "model " + std::to_string(info.model) + ", firmware " +
         std::to_string(info.firmware_major) + "." + std::to_string(info.firmware_minor) +
         ", hardware " + std::to_string(info.hardware);
}

std::array<std::uint8_t, kRpSample_bytes> rp_bytes(const RpSample& sample) {
  const unsigned start = sample.starts_turn ? 1U : 2U;
  const unsigned angle = static_cast<unsigned>(sample.angle_q6) << 1 | 1U;
  return {static_cast<std::uint8_t>(static_cast<unsigned>(sample.quality) << 2 | start),
          static_cast<std::uint8_t>(angle & 0xFFU), static_cast<std::uint8_t>(angle >> 8 & 0xFFU),
          static_cast<std::uint8_t>(sample.distance_q2 & 0xFFU),
          static_cast<std::uint8_t>(sample.distance_q2 >> 8)};
}

std::optional<RpSample> rp_sample(std::span<const std::uint8_t> bytes) {
  const bool starts = (bytes[0] & 1U) != 0;
  const bool inverse = (bytes[0] & 2U) != 0;
  const auto angle_q6 = static_cast<std::uint16_t>(word_at(bytes, 1) >> 1);
  if (starts == inverse || (bytes[1] & 1U) == 0 || angle_q6 >= kRpTurnQ6) return std::nullopt;
  return RpSample{starts, static_cast<std::uint8_t>(bytes[0] >> 2), angle_q6, word_at(bytes, 3)};
}

std::vector<std::uint8_t> rp_bytes(const RpPacket& packet, std::uint8_t type) {
  std::vector<std::uint8_t> bytes{kFirstMark, kSecondMark};
  put_word(bytes, packet.start_q6 | (packet.starts ? 1U << 15 : 0U));
  if (type == rp_answer::kDense) {
    for (const RpPacket::Point& point : packet.points) {
      put_word(bytes, static_cast<unsigned>(point.distance_mm));
    }
  } else {
    put_express_cabins(packet, bytes);
  }
  const std::uint8_t sum = xor_of(std::span(bytes).subspan(kPayloadAt));
  bytes[0] |= sum & 0xFU;
  bytes[1] |= sum >> 4;
  return bytes;
}

std::optional<RpPacket> rp_packet(std::span<const std::uint8_t> bytes, std::uint8_t type) {
  if ((bytes[0] & 0xF0U) != kFirstMark || (bytes[1] & 0xF0U) != kSecondMark) return std::nullopt;
  const unsigned sum = (bytes[0] & 0xFU) | (bytes[1] & 0xFU) << 4;
  if (xor_of(bytes.subspan(kPayloadAt)) != sum) return std::nullopt;
  const unsigned start = word_at(bytes, kPayloadAt);
  RpPacket packet;
  packet.start_q6 = static_cast<std::uint16_t>(start & 0x7FFFU);
  packet.starts = start >> 15 != 0;
  if (packet.start_q6 >= kRpTurnQ6) return std::nullopt;
  if (type == rp_answer::kDense) {
    packet.points.reserve(kRpDensePoints);
    for (std::size_t at = kCabinsAt; at + 1 < bytes.size(); at += 2) {
      packet.points.push_back({static_cast<double>(word_at(bytes, at)), 0});
    }
  } else {
    packet.points.reserve(kRpExpressPoints);
    take_express_cabins(bytes, packet);
  }
  return packet;
}

double rp_angle_deg(const RpPacket& packet, std::uint16_t next_start_q6, std::size_t k,
                    bool compensation_signed) {
  const double step_deg = (kRpTurnQ6 + next_start_q6 - packet.start_q6) % kRpTurnQ6 / 64.0 /
                          static_cast<double>(packet.points.size());
  int compensation_q3 = packet.points[k].compensation_q3;
  if (compensation_signed && compensation_q3 >= 32) compensation_q3 -= 64;
  return packet.start_q6 / 64.0 + step_deg * static_cast<double>(k) - compensation_q3 / 8.0;
}

}  // namespace topogeo::devices
