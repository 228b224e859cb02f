// Packets of RTPS from their parts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace topogeo::messaging {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kLittle = 1;
constexpr std::uint32_t kNobody = 0;
constexpr std::uint32_t kUserWriter = 0x00000102;
constexpr std::uint32_t kSpdpWriter = 0x000100c2;
constexpr std::uint32_t kSedpWriter = 0x000003c2;

inline Bytes& operator<<(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
  return bytes;
}

inline Bytes joined(const std::vector<Bytes>& parts) {
  Bytes bytes;
  for (const Bytes& part : parts) bytes << part;
  return bytes;
}

inline Bytes u16(std::uint32_t value) {
  return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U)};
}

inline Bytes u32(std::uint32_t value) {
  return joined({u16(value), u16(value >> 16U)});
}

inline Bytes entity(std::uint32_t id) {
  Bytes bytes = u32(id);
  std::ranges::reverse(bytes);
  return bytes;
}

/// A sequence number: the high half first.
inline Bytes number(std::int64_t value) {
  return joined(
      {u32(static_cast<std::uint32_t>(value >> 32)), u32(static_cast<std::uint32_t>(value))});
}

inline Bytes submessage(std::uint8_t kind, std::uint8_t flags, const Bytes& body) {
  return joined({{kind, flags}, u16(static_cast<std::uint32_t>(body.size())), body});
}

inline Bytes packet(const std::vector<Bytes>& submessages) {
  const Bytes header = {'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  return joined({header, joined(submessages)});
}

inline Bytes parameter(std::uint32_t id, const Bytes& value) {
  return joined({u16(id), u16(static_cast<std::uint32_t>(value.size())), value});
}

inline const Bytes kEndOfList = {1, 0, 0, 0};  // NOLINT(cert-err58-cpp): a test's constant
inline const Bytes kPayload = {0, 1, 0, 0, 7, 0, 0, 0};  // NOLINT(cert-err58-cpp)

inline Bytes data(std::uint8_t flags, const Bytes& rest, std::int64_t at = 1,
                  std::uint32_t writer = kUserWriter) {
  return submessage(0x15, static_cast<std::uint8_t>(flags | kLittle),
                    joined({u16(0), u16(16), entity(kNobody), entity(writer), number(at), rest}));
}

inline Bytes fragment(std::uint32_t first, std::uint32_t count, std::uint32_t size,
                      std::uint32_t sample, std::size_t payload) {
  return submessage(0x16, kLittle,
                    joined({u16(0), u16(28), entity(kNobody), entity(kUserWriter), number(1),
                            u32(first), u16(count), u16(size), u32(sample), Bytes(payload, 7)}));
}

inline Bytes heartbeat(std::int64_t first, std::int64_t last, std::uint32_t writer = kUserWriter) {
  return submessage(0x07, kLittle,
                    joined({entity(kNobody), entity(writer), number(first), number(last), u32(1)}));
}

inline Bytes gap(std::int64_t first, std::int64_t end, std::uint32_t bits, std::size_t words) {
  return submessage(0x08, kLittle,
                    joined({entity(kNobody), entity(kUserWriter), number(first), number(end),
                            u32(bits), Bytes(4 * words, 0xff)}));
}

inline Bytes acknack(std::int64_t base, std::uint32_t bits, std::size_t words) {
  return submessage(0x06, kLittle,
                    joined({entity(kNobody), entity(kUserWriter), number(base), u32(bits),
                            Bytes(4 * words, 0xff), u32(1)}));
}

inline Bytes nack_fragment(std::uint32_t base, std::uint32_t bits, std::size_t words) {
  return submessage(0x12, kLittle,
                    joined({entity(kNobody), entity(kUserWriter), number(1), u32(base), u32(bits),
                            Bytes(4 * words, 0xff), u32(1)}));
}

inline Bytes text(const std::string& characters) {
  Bytes bytes = u32(static_cast<std::uint32_t>(characters.size() + 1));
  bytes.insert(bytes.end(), characters.begin(), characters.end());
  bytes.resize(4 + (characters.size() + 4) / 4 * 4);
  return bytes;
}

inline Bytes list(const std::vector<Bytes>& parameters) {
  return joined({{0, 3, 0, 0}, joined(parameters), kEndOfList});
}

}  // namespace topogeo::messaging
