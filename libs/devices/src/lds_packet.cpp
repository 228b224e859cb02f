#include "topogeo/devices/lds_packet.hpp"

#include <algorithm>

#include "topogeo/devices/little_endian.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kLdsHeader = 0xFA;
constexpr std::uint8_t kFirstNumber = 0xA0;
constexpr std::size_t kReadingsAt = 4;
constexpr std::uint16_t kInvalidMark = 0x8000;
constexpr std::uint16_t kLdsDistanceMask = 0x3FFF;
/// Neither laser measures slower or faster; both aim at 300.
constexpr double kSlowestRpm = 60.0;
constexpr double kFastestRpm = 900.0;
constexpr int kRightUntilLearned = 8;
constexpr int kSeenUntilGivenUp = 64;

LdsPacket lds_packet_of(std::span<const std::uint8_t> bytes, const LdsFormat& format) {
  LdsPacket packet;
  packet.number = static_cast<std::size_t>(bytes[1] - kFirstNumber);
  packet.speed = word_at(bytes, 2);
  for (std::size_t i = 0; i < format.readings; ++i) {
    const std::size_t at = kReadingsAt + i * format.reading_bytes;
    const std::uint16_t first = word_at(bytes, at);
    const std::uint16_t second = word_at(bytes, at + 2);
    LdsReading reading =
        format.intensity_first ? LdsReading{second, first} : LdsReading{first, second};
    if (format.flags) {
      const bool invalid = (reading.distance_mm & kInvalidMark) != 0;
      reading.distance_mm =
          invalid ? std::uint16_t{0}
                  : static_cast<std::uint16_t>(reading.distance_mm & kLdsDistanceMask);
    }
    packet.readings.push_back(reading);
  }
  return packet;
}

}  // namespace

std::uint16_t lds_checksum(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) sum = (sum << 1) + word_at(bytes, at);
  return static_cast<std::uint16_t>(((sum & 0x7FFFU) + (sum >> 15)) & 0x7FFFU);
}

std::vector<std::uint8_t> lds_bytes(const LdsPacket& packet, const LdsFormat& format) {
  std::vector<std::uint8_t> bytes{kLdsHeader,
                                  static_cast<std::uint8_t>(kFirstNumber + packet.number)};
  bytes.reserve(format.packet_bytes());
  put_word(bytes, packet.speed);
  for (const LdsReading& reading : packet.readings) {
    const bool none = format.flags && reading.distance_mm == 0;
    const std::uint16_t distance = none ? kInvalidMark : reading.distance_mm;
    put_word(bytes, format.intensity_first ? reading.intensity : distance);
    put_word(bytes, format.intensity_first ? distance : reading.intensity);
    for (std::size_t i = 4; i < format.reading_bytes; ++i) bytes.push_back(0);
  }
  put_word(bytes, lds_checksum(bytes));
  return bytes;
}

void LdsDecoder::clear() {
  buffer_.clear();
  checksum_ = setting_;
  right_ = seen_ = 0;
}

void LdsDecoder::drop_byte() {
  buffer_.pop_front();
  ++counters_.noise_bytes;
}

bool LdsDecoder::is_number(std::uint8_t byte) const {
  return byte >= kFirstNumber && byte < kFirstNumber + format_.packets;
}

bool LdsDecoder::accepts(bool intact) {
  if (checksum_ == LdsChecksum::kLearn) {
    right_ = intact ? right_ + 1 : 0;
    ++seen_;
    if (right_ >= kRightUntilLearned) checksum_ = LdsChecksum::kDrop;
    if (seen_ >= kSeenUntilGivenUp && right_ == 0) checksum_ = LdsChecksum::kWarn;
    if (checksum_ == LdsChecksum::kLearn) return false;
  }
  if (!intact) ++counters_.bad_checksum;
  return intact || checksum_ == LdsChecksum::kWarn;
}

std::optional<LdsDecoder::Found> LdsDecoder::next() {
  const std::size_t size = format_.packet_bytes();
  while (!buffer_.empty()) {
    if (buffer_[0] == kLdsHeader && buffer_.size() == 1) return std::nullopt;
    if (buffer_[0] != kLdsHeader || !is_number(buffer_[1])) {
      drop_byte();
      continue;
    }
    if (buffer_.size() < size + 2) return std::nullopt;
    const std::vector<std::uint8_t> bytes(buffer_.begin(),
                                          buffer_.begin() + static_cast<std::ptrdiff_t>(size));
    const std::span<const std::uint8_t> all(bytes);
    const bool intact = lds_checksum(all.first(size - 2)) == word_at(all, size - 2);
    LdsPacket packet = lds_packet_of(all, format_);
    const std::size_t next_number = (packet.number + 1) % format_.packets;
    if (buffer_[size] != kLdsHeader || buffer_[size + 1] != kFirstNumber + next_number) {
      // The header may have been a reading: the packet may begin within these bytes.
      ++(intact ? counters_.alone : counters_.bad_checksum);
      drop_byte();
      continue;
    }
    const double rpm = packet.speed * format_.rpm_per_unit;
    const bool possible = rpm >= kSlowestRpm && rpm <= kFastestRpm;
    if (!possible) ++counters_.implausible;
    const bool accepted = possible && accepts(intact);
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size));
    if (accepted) return Found{std::move(packet), buffer_.size()};
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
