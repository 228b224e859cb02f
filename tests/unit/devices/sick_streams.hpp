// Byte streams for the tests of the SICK telegrams: telegrams printed by others, and a decoder's
// events for a stream.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/sick_telegram.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::int64_t kByteGap_ns = 35'000'000;

/// Bytes from hexadecimal digits, two each, with spaces between.
inline Bytes hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 3) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// A reply with measured values of these words.
inline Bytes measured_values(const std::vector<std::uint16_t>& words, std::uint8_t status = 0) {
  Bytes data{static_cast<std::uint8_t>(words.size() & 0xFFU),
             static_cast<std::uint8_t>(words.size() >> 8)};
  for (const std::uint16_t word : words) {
    data.push_back(static_cast<std::uint8_t>(word & 0xFFU));
    data.push_back(static_cast<std::uint8_t>(word >> 8));
  }
  return sick_reply(0xB0, data, status);
}

inline void append(Bytes& stream, std::span<const std::uint8_t> bytes) {
  stream.insert(stream.end(), bytes.begin(), bytes.end());
}

/// All bytes of an event's telegram, or its single byte.
inline Bytes bytes_of(const SickEvent& event) {
  switch (event.kind) {
    case SickEvent::Kind::kAck:
      return {kSickAck};
    case SickEvent::Kind::kNak:
      return {kSickNak};
    case SickEvent::Kind::kTelegram:
      break;
  }
  const SickTelegram& telegram = event.telegram;
  if (telegram.address < 0x80) return sick_command(telegram.code, telegram.data, telegram.address);
  return sick_reply(telegram.code, telegram.data, telegram.status, telegram.address);
}

inline void drain(SickDecoder& decoder, std::vector<Bytes>& found) {
  while (const auto event = decoder.next()) found.push_back(bytes_of(*event));
}

/// All events of the stream, passed in parts of at most `part` bytes without gaps.
inline std::vector<Bytes> decode(SickDecoder& decoder, std::span<const std::uint8_t> stream,
                                 std::size_t part, std::int64_t now_ns = 0) {
  std::vector<Bytes> found;
  for (std::size_t at = 0; at < stream.size(); at += part) {
    decoder.push(stream.subspan(at, std::min(part, stream.size() - at)), now_ns);
    drain(decoder, found);
  }
  decoder.tick(now_ns + kByteGap_ns);
  drain(decoder, found);
  return found;
}

inline Bytes random_bytes(support::Random& random, std::size_t most) {
  Bytes bytes(random.below(most + 1));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
  return bytes;
}

}  // namespace topogeo::devices
