#include "topogeo/devices/sick_telegram.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "topogeo/devices/sick_crc.hpp"

namespace topogeo::devices {
namespace {

constexpr std::size_t kHeader_bytes = 4;
constexpr std::size_t kCrc_bytes = 2;
constexpr std::uint8_t kFromSensor = 0x80;
constexpr std::uint8_t kMeasuredValues = 0xB0;
/// Bits 10 to 15 of the number of readings are flags.
constexpr std::size_t kCountMask = 0x3FF;
/// Number of handled bytes at which they are removed from the buffer.
constexpr std::size_t kCompactAt_bytes = 4096;

std::size_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::size_t>(bytes[at]) | static_cast<std::size_t>(bytes[at + 1]) << 8;
}

std::vector<std::uint8_t> frame(std::uint8_t address, std::uint8_t code,
                                std::span<const std::uint8_t> data,
                                std::optional<std::uint8_t> status, std::size_t longest) {
  const std::size_t length = 1 + data.size() + (status ? 1 : 0);
  if (length > longest) {
    throw std::invalid_argument("a telegram of " + std::to_string(length) +
                                " bytes, expected at most " + std::to_string(longest));
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(length + kSickFrame_bytes);
  bytes.assign({kSickStx, address, static_cast<std::uint8_t>(length & 0xFFU),
                static_cast<std::uint8_t>(length >> 8), code});
  bytes.insert(bytes.end(), data.begin(), data.end());
  if (status) bytes.push_back(*status);
  const std::uint16_t crc = sick_crc(bytes);
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> sick_command(std::uint8_t command, std::span<const std::uint8_t> data,
                                       std::uint8_t address) {
  return frame(address, command, data, std::nullopt, kSickLongestCommand_bytes);
}

std::vector<std::uint8_t> sick_reply(std::uint8_t code, std::span<const std::uint8_t> data,
                                     std::uint8_t status, std::uint8_t address) {
  if ((address & kFromSensor) == 0) {
    throw std::invalid_argument("the address of a sensor's telegram is " + std::to_string(address) +
                                ", expected at least 128");
  }
  return frame(address, code, data, status, kSickLongestReply_bytes);
}

std::size_t SickTelegram::size() const {
  const std::size_t status_bytes = (address & kFromSensor) != 0 ? 1 : 0;
  return data.size() + 1 + status_bytes + kSickFrame_bytes;
}

SickDecoder::SickDecoder(Listener listener, std::int64_t byte_gap_ns)
    : listener_(listener), byte_gap_ns_(byte_gap_ns) {}

void SickDecoder::push(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (bytes.empty()) return;
  tick(now_ns);
  compact();
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  arrivals_.push_back({end(), now_ns});
  last_push_ns_ = now_ns;
}

std::optional<SickEvent> SickDecoder::next() {
  while (head_ < buffer_.size()) {
    if (failed_until_ != 0 && position() >= failed_until_) settle_failure(false);
    if (const std::optional<SickEvent::Kind> kind = single_byte()) {
      ++(*kind == SickEvent::Kind::kAck ? counters_.acks : counters_.naks);
      ++head_;
      in_step_at_ = position();
      return SickEvent{*kind};
    }
    const Judgement found = judge(std::span(buffer_).subspan(head_));
    switch (found.verdict) {
      case Verdict::kTelegram:
        return SickEvent{SickEvent::Kind::kTelegram, take_telegram(found.size)};
      case Verdict::kWait:
        if (position() >= silent_at_) return std::nullopt;
        drop(found.verdict, found.size);
        break;
      case Verdict::kEcho:
        ++counters_.echoes;
        head_ += found.size;
        in_step_at_ = position();
        break;
      case Verdict::kNoise:
        skip_noise(found.size);
        break;
      case Verdict::kImplausibleLength:
      case Verdict::kBadCrc:
        drop(found.verdict, found.size);
        break;
    }
  }
  if (failed_until_ != 0 && position() >= failed_until_) settle_failure(false);
  return std::nullopt;
}

void SickDecoder::tick(std::int64_t now_ns) {
  if (now_ns - last_push_ns_ < byte_gap_ns_) return;
  silent_at_ = end();
}

std::int64_t SickDecoder::due_ns() const {
  if (head_ == buffer_.size() || position() < silent_at_) {
    return std::numeric_limits<std::int64_t>::max();
  }
  return last_push_ns_ + byte_gap_ns_;
}

void SickDecoder::clear() {
  base_ = end();
  buffer_.clear();
  arrivals_.clear();
  head_ = 0;
  failed_until_ = 0;
  silent_at_ = base_;
  counted_until_ = base_;
}

SickDecoder::Judgement SickDecoder::judge(std::span<const std::uint8_t> bytes) const {
  const auto stx = std::ranges::find(bytes, kSickStx);
  const auto before = static_cast<std::size_t>(stx - bytes.begin());
  if (before > 0) return {Verdict::kNoise, before};
  if (bytes.size() < 2) return {Verdict::kWait, 1};
  const bool from_sensor = (bytes[1] & kFromSensor) != 0;
  // A host that calls a single sensor uses the address 0; other addresses below 80 count as noise.
  const bool possible =
      listener_ == Listener::kSensor ? !from_sensor : from_sensor || bytes[1] == 0;
  if (!possible) return {Verdict::kNoise, 1};
  if (bytes.size() < kHeader_bytes) return {Verdict::kWait, bytes.size()};
  return judge_contents(bytes);
}

SickDecoder::Judgement SickDecoder::judge_contents(std::span<const std::uint8_t> bytes) const {
  const bool from_sensor = (bytes[1] & kFromSensor) != 0;
  const bool echo = listener_ == Listener::kHost && !from_sensor;
  const std::size_t length = word(bytes, 2);
  const std::size_t shortest = from_sensor ? 2 : 1;
  const std::size_t longest = from_sensor ? kSickLongestReply_bytes : kSickLongestCommand_bytes;
  const Judgement implausible{echo ? Verdict::kNoise : Verdict::kImplausibleLength,
                              echo ? 1 : kHeader_bytes};
  if (length < shortest || length > longest) return implausible;
  const std::size_t size = length + kSickFrame_bytes;
  if (from_sensor && bytes.size() > kHeader_bytes && bytes[kHeader_bytes] == kMeasuredValues) {
    if (length < 4) return implausible;
    if (bytes.size() < kHeader_bytes + 3) return {Verdict::kWait, size};
    if ((word(bytes, kHeader_bytes + 1) & kCountMask) * 2 + 4 != length) return implausible;
  }
  if (bytes.size() < size) return {Verdict::kWait, size};
  if (sick_crc(bytes.first(size - kCrc_bytes)) != word(bytes, size - kCrc_bytes)) {
    return echo ? Judgement{Verdict::kNoise, 1} : Judgement{Verdict::kBadCrc, size};
  }
  return {echo ? Verdict::kEcho : Verdict::kTelegram, size};
}

/// Inside a telegram, and also in the remains of a broken one, 06 and 15 are ordinary bytes.
std::optional<SickEvent::Kind> SickDecoder::single_byte() const {
  const bool in_step = position() == in_step_at_ || position() == silent_at_;
  if (listener_ != Listener::kHost || !in_step) return std::nullopt;
  if (buffer_[head_] == kSickAck) return SickEvent::Kind::kAck;
  if (buffer_[head_] == kSickNak) return SickEvent::Kind::kNak;
  return std::nullopt;
}

SickTelegram SickDecoder::take_telegram(std::size_t size) {
  if (failed_until_ != 0) settle_failure(true);
  ++counters_.telegrams;
  const std::span<const std::uint8_t> bytes = std::span(buffer_).subspan(head_, size);
  head_ += size;
  in_step_at_ = position();
  while (arrivals_.front().end < position()) arrivals_.pop_front();
  SickTelegram telegram;
  telegram.address = bytes[1];
  telegram.code = bytes[kHeader_bytes];
  telegram.data = bytes.subspan(kHeader_bytes + 1, size - kSickFrame_bytes - 1);
  if ((telegram.address & kFromSensor) != 0) {
    telegram.status = telegram.data.back();
    telegram.data = telegram.data.first(telegram.data.size() - 1);
  }
  telegram.arrived_ns = arrivals_.front().at_ns;
  telegram.bytes_since = static_cast<std::size_t>(arrivals_.front().end - position());
  return telegram;
}

void SickDecoder::skip_noise(std::size_t size) {
  const std::uint64_t first = std::max(position(), counted_until_);
  head_ += size;
  if (position() > first) counters_.noise_bytes += position() - first;
}

/// A lone STX, or the start of an echo, is too little for a truncated telegram.
bool SickDecoder::starts_reply() const {
  if (silent_at_ - position() < 2) return false;
  return listener_ == Listener::kSensor || (buffer_[head_ + 1] & kFromSensor) != 0;
}

/// Counts the apparent telegram here as one dropped item, unless it is part of one already counted,
/// and goes on with the next byte.
void SickDecoder::drop(Verdict verdict, std::size_t size) {
  std::uint64_t until = position() + size;
  if (position() >= counted_until_ && (verdict != Verdict::kWait || starts_reply())) {
    if (verdict == Verdict::kImplausibleLength) ++counters_.implausible_length;
    if (verdict == Verdict::kWait) {
      ++counters_.truncated;
      until = silent_at_;
    }
    if (verdict == Verdict::kBadCrc) failed_until_ = until;
    counted_until_ = until;
  }
  skip_noise(1);
}

/// A telegram with a bad check word was truncated if another, good one begins inside it.
void SickDecoder::settle_failure(bool by_telegram) {
  const bool inside = by_telegram && position() < failed_until_;
  ++(inside ? counters_.truncated : counters_.bad_crc);
  failed_until_ = 0;
}

void SickDecoder::compact() {
  if (head_ != buffer_.size() && head_ < kCompactAt_bytes) return;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(head_));
  base_ += head_;
  head_ = 0;
  while (!arrivals_.empty() && arrivals_.front().end <= base_) arrivals_.pop_front();
}

}  // namespace topogeo::devices
