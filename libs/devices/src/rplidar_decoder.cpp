#include "topogeo/devices/rplidar_decoder.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::devices {
namespace {

/// The ultra packets of the A3 have no decoder here.
constexpr std::uint8_t kUltra = 0x84;
constexpr std::uint32_t kUltra_bytes = 132;

/// Whether a laser sends such an answer: noise may look like the start of a descriptor.
bool is_known(const RpDescriptor& descriptor) {
  constexpr std::array<RpDescriptor, 7> kKnown{{{kRpInfo_bytes, false, rp_answer::kInfo},
                                                {3, false, rp_answer::kHealth},
                                                {4, false, rp_answer::kSampleRate},
                                                {kRpSample_bytes, true, rp_answer::kScan},
                                                {kRpPacket_bytes, true, rp_answer::kExpress},
                                                {kRpPacket_bytes, true, rp_answer::kDense},
                                                {kUltra_bytes, true, kUltra}}};
  return std::ranges::find(kKnown, descriptor) != kKnown.end();
}

}  // namespace

void RpDecoder::expect_descriptor() {
  buffer_.clear();
  scan_.reset();
  contiguous_ = true;
}

void RpDecoder::drop_byte() {
  buffer_.pop_front();
  ++counters_.noise_bytes;
  contiguous_ = false;
}

std::vector<std::uint8_t> RpDecoder::front(std::size_t count) const {
  return {buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count)};
}

RpDecoder::Answer RpDecoder::take(const RpDescriptor& descriptor, std::size_t header,
                                  std::size_t data) {
  std::vector<std::uint8_t> bytes = front(header + data);
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(bytes.size()));
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header));
  return {descriptor, std::move(bytes), buffer_.size(), std::exchange(contiguous_, true)};
}

std::optional<RpDecoder::Answer> RpDecoder::next() {
  return scan_ ? next_sample() : next_descriptor();
}

std::optional<RpDecoder::Answer> RpDecoder::next_descriptor() {
  while (buffer_.size() >= kRpDescriptor_bytes) {
    const std::optional<RpDescriptor> descriptor = rp_descriptor(front(kRpDescriptor_bytes));
    if (!descriptor || !is_known(*descriptor)) {
      drop_byte();
      continue;
    }
    if (descriptor->repeats) {
      scan_ = descriptor;
      return take(*descriptor, kRpDescriptor_bytes, 0);
    }
    if (buffer_.size() < kRpDescriptor_bytes + descriptor->length) return std::nullopt;
    return take(*descriptor, kRpDescriptor_bytes, descriptor->length);
  }
  return std::nullopt;
}

bool RpDecoder::is_sample(std::span<const std::uint8_t> bytes) {
  if (scan_->type == rp_answer::kScan) return rp_sample(bytes).has_value();
  if (rp_packet(bytes, scan_->type)) return true;
  if ((bytes[0] & 0xF0U) == 0xA0U && (bytes[1] & 0xF0U) == 0x50U) ++counters_.bad_checksum;
  return false;
}

std::optional<RpDecoder::Answer> RpDecoder::next_sample() {
  while (buffer_.size() >= scan_->length) {
    if (is_sample(front(scan_->length))) return take(*scan_, 0, scan_->length);
    drop_byte();
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
