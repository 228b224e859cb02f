#include "topogeo/devices/envelope.hpp"

#include <limits>
#include <stdexcept>
#include <string>

#include "topogeo/devices/little_endian.hpp"
#include "topogeo/devices/sick_crc.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kEnvelopeFirst = 'T';
constexpr std::uint8_t kEnvelopeSecond = 'E';
constexpr std::size_t kEnvelopeHead = 5;
constexpr std::size_t kEnvelopeSum = 2;

bool begins(std::span<const std::uint8_t> bytes) {
  if (bytes[0] != kEnvelopeFirst) return false;
  if (bytes.size() > 1 && bytes[1] != kEnvelopeSecond) return false;
  return bytes.size() < 3 || (bytes[2] >= static_cast<std::uint8_t>(EnvelopeKind::kHost) &&
                              bytes[2] <= static_cast<std::uint8_t>(EnvelopeKind::kDatagram));
}

}  // namespace

void put_envelope(std::vector<std::uint8_t>& bytes, EnvelopeKind kind,
                  std::span<const std::uint8_t> contents) {
  if (contents.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::invalid_argument("an envelope of " + std::to_string(contents.size()) +
                                " bytes: expected at most 65,535");
  }
  const auto start = static_cast<std::ptrdiff_t>(bytes.size());
  bytes.push_back(kEnvelopeFirst);
  bytes.push_back(kEnvelopeSecond);
  bytes.push_back(static_cast<std::uint8_t>(kind));
  put_word(bytes, static_cast<unsigned>(contents.size()));
  bytes.insert(bytes.end(), contents.begin(), contents.end());
  put_word(bytes, sick_crc({bytes.begin() + start, bytes.end()}));
}

std::vector<Envelope> EnvelopeReader::read(std::span<const std::uint8_t> bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  std::vector<Envelope> envelopes;
  std::span<const std::uint8_t> rest(buffer_);
  while (!rest.empty()) {
    if (!begins(rest)) {
      ++noise_bytes_;
      rest = rest.subspan(1);
      continue;
    }
    if (rest.size() < kEnvelopeHead) break;
    const std::size_t end = kEnvelopeHead + word_at(rest, 3);
    if (rest.size() < end + kEnvelopeSum) break;
    if (word_at(rest, end) != sick_crc(rest.first(end))) {
      ++bad_checksum_;
      rest = rest.subspan(1);
      continue;
    }
    const auto contents = rest.subspan(kEnvelopeHead, end - kEnvelopeHead);
    envelopes.push_back({static_cast<EnvelopeKind>(rest[2]), {contents.begin(), contents.end()}});
    rest = rest.subspan(end + kEnvelopeSum);
  }
  buffer_.erase(buffer_.begin(), buffer_.end() - static_cast<std::ptrdiff_t>(rest.size()));
  return envelopes;
}

}  // namespace topogeo::devices
