#include "topogeo/devices/ydlidar_packet.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/devices/little_endian.hpp"
#include "topogeo/devices/rplidar_protocol.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kYdFirst = 0xAA;
constexpr std::uint8_t kYdSecond = 0x55;
constexpr std::uint8_t kYdAnswer = 0xA5;
constexpr std::uint8_t kYdAnswerSecond = 0x5A;
constexpr std::size_t kYdHeader_bytes = 10;
constexpr std::size_t kChecksumAt = 8;
/// 40 samples of a triangulating laser at 12 turns and 4,000 samples a second span 43 degrees.
constexpr unsigned kYdWidestQ6 = 60 * 64;
/// Geometry of the triangulating models, millimetres.
constexpr double kBase_mm = 21.8;
constexpr double kFocus_mm = 155.3;

/// The XOR of all words but the checksum.
std::uint16_t yd_checksum(std::span<const std::uint8_t> bytes) {
  unsigned sum = 0;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    if (at != kChecksumAt) sum ^= word_at(bytes, at);
  }
  return static_cast<std::uint16_t>(sum);
}

bool yd_possible(const YdPacket& packet) {
  const bool angles =
      packet.first_q6 < kYdTurnQ6 && packet.last_q6 < kYdTurnQ6 && packet.span_q6() <= kYdWidestQ6;
  return packet.samples.size() == 1 ? angles && packet.first_q6 == packet.last_q6
                                    : angles && packet.span_q6() > 0 && !packet.starts_turn;
}

}  // namespace

unsigned YdPacket::span_q6() const {
  return (kYdTurnQ6 + last_q6 - first_q6) % kYdTurnQ6;
}

std::vector<std::uint8_t> yd_bytes(const YdPacket& packet) {
  std::vector<std::uint8_t> bytes{kYdFirst, kYdSecond};
  const unsigned kind =
      static_cast<unsigned>(packet.turns_dhz) << 1 | (packet.starts_turn ? 1U : 0U);
  bytes.push_back(static_cast<std::uint8_t>(kind));
  bytes.push_back(static_cast<std::uint8_t>(packet.samples.size()));
  // The lowest bit of an angle is always set.
  put_word(bytes, packet.first_q6 << 1 | 1U);
  put_word(bytes, packet.last_q6 << 1 | 1U);
  put_word(bytes, 0);
  for (const std::uint16_t sample : packet.samples) put_word(bytes, sample);
  const std::uint16_t checksum = yd_checksum(bytes);
  bytes[kChecksumAt] = static_cast<std::uint8_t>(checksum & 0xFFU);
  bytes[kChecksumAt + 1] = static_cast<std::uint8_t>(checksum >> 8);
  return bytes;
}

double yd_correction_deg(double distance_mm) {
  if (distance_mm <= 0.0) return 0.0;
  return std::atan(kBase_mm * (kFocus_mm - distance_mm) / (kFocus_mm * distance_mm)) * 180.0 /
         std::numbers::pi;
}

double yd_far_correction_deg() {
  return -std::atan(kBase_mm / kFocus_mm) * 180.0 / std::numbers::pi;
}

std::vector<std::uint8_t> yd_request(std::uint8_t command) {
  return {kYdAnswer, command};
}

std::vector<std::uint8_t> YdDecoder::front(std::size_t count) const {
  return {buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count)};
}

void YdDecoder::drop(std::size_t count) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count));
}

YdDecoder::Need YdDecoder::take_packet(Found& found) {
  if (buffer_.size() < 4) return Need::kMore;
  const std::size_t samples = buffer_[3];
  const std::size_t size = kYdHeader_bytes + 2 * samples;
  if (samples == 0) return Need::kNoise;
  if (buffer_.size() < size + 2) return Need::kMore;
  const bool packet_next = buffer_[size] == kYdFirst && buffer_[size + 1] == kYdSecond;
  const bool answer_next = buffer_[size] == kYdAnswer && buffer_[size + 1] == kYdAnswerSecond;
  const std::vector<std::uint8_t> bytes = front(size);
  if (yd_checksum(bytes) != word_at(bytes, kChecksumAt)) {
    ++counters_.bad_checksum;
    return Need::kNoise;
  }
  if (!packet_next && !answer_next) {
    ++counters_.alone;
    return Need::kNoise;
  }
  YdPacket packet;
  packet.starts_turn = (bytes[2] & 1U) != 0;
  packet.turns_dhz = static_cast<std::uint8_t>(packet.starts_turn ? bytes[2] >> 1 : 0);
  packet.first_q6 = static_cast<std::uint16_t>(word_at(bytes, 4) >> 1);
  packet.last_q6 = static_cast<std::uint16_t>(word_at(bytes, 6) >> 1);
  for (std::size_t i = 0; i < samples; ++i) {
    packet.samples.push_back(word_at(bytes, kYdHeader_bytes + 2 * i));
  }
  if (!yd_possible(packet)) {
    ++counters_.implausible;
    return Need::kNoise;
  }
  drop(size);
  found.packet = std::move(packet);
  return Need::kFound;
}

YdDecoder::Need YdDecoder::take_answer(Found& found) {
  if (buffer_.size() < kRpDescriptor_bytes) return Need::kMore;
  const auto descriptor = rp_descriptor(front(kRpDescriptor_bytes));
  if (!descriptor) return Need::kNoise;
  const bool info = descriptor->type == yd_answer::kInfo && descriptor->length == kYdInfo_bytes;
  const bool health =
      descriptor->type == yd_answer::kHealth && descriptor->length == kYdHealth_bytes;
  const bool scan = descriptor->type == yd_answer::kScan && descriptor->repeats;
  if (!info && !health && !scan) return Need::kNoise;
  const std::size_t size = kRpDescriptor_bytes + (scan ? 0 : descriptor->length);
  if (buffer_.size() < size) return Need::kMore;
  const std::vector<std::uint8_t> bytes = front(size);
  drop(size);
  found.answer_type = descriptor->type;
  found.answer.assign(bytes.begin() + static_cast<std::ptrdiff_t>(kRpDescriptor_bytes),
                      bytes.end());
  return Need::kFound;
}

std::optional<YdDecoder::Found> YdDecoder::next() {
  while (!buffer_.empty()) {
    const bool packet = buffer_[0] == kYdFirst;
    const bool answer = buffer_[0] == kYdAnswer;
    if ((packet || answer) && buffer_.size() == 1) return std::nullopt;
    Found found;
    Need need = Need::kNoise;
    if (packet && buffer_[1] == kYdSecond) need = take_packet(found);
    if (answer && buffer_[1] == kYdAnswerSecond) need = take_answer(found);
    if (need == Need::kMore) return std::nullopt;
    if (need == Need::kFound) {
      found.bytes_since = buffer_.size();
      return found;
    }
    drop(1);
    ++counters_.noise_bytes;
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
