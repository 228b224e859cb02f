#include "lease.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "packet_reader.hpp"

namespace topogeo::messaging {

namespace {

constexpr std::size_t kListHeader_bytes = 4;
constexpr std::uint16_t kEndOfList = 0x0001;
constexpr std::uint16_t kLeaseParameter = 0x0002;
constexpr std::uint16_t kLease_bytes = 8;

template <class Number>
void write_number(std::span<std::uint8_t> bytes, Number number, bool little_endian) {
  for (std::size_t at = 0; at < sizeof(Number); ++at) {
    const std::size_t shift = 8 * (little_endian ? at : sizeof(Number) - 1 - at);
    bytes[at] = static_cast<std::uint8_t>(number >> shift);
  }
}

void bound_value(std::span<std::uint8_t> value, bool little_endian) {
  const std::uint32_t seconds = PacketReader(value, little_endian).u32();
  if (seconds >= kShortestLease_s && seconds < kLongestLease_s) return;
  std::ranges::fill(value, std::uint8_t{0});
  write_number(value, std::clamp(seconds, kShortestLease_s, kLongestLease_s), little_endian);
}

bool bound_all(std::span<std::uint8_t> list, bool little_endian) {
  PacketReader reader(list, little_endian);
  reader.skip(kListHeader_bytes);
  bool found = false;
  while (true) {
    const std::uint16_t id = reader.u16();
    const std::uint16_t size = reader.u16();
    if (!reader.ok() || id == kEndOfList) return found;
    const std::size_t at = reader.position();
    reader.skip(size);
    reader.align();
    if (id != kLeaseParameter || size < kLease_bytes) continue;
    bound_value(list.subspan(at, kLease_bytes), little_endian);
    found = true;
  }
}

}  // namespace

bool bound_lease(std::vector<std::uint8_t>& packet, std::size_t submessage_at,
                 std::size_t payload_at, std::size_t payload_end) {
  const std::span<std::uint8_t> bytes(packet);
  const bool list_little = (bytes[payload_at + 1] & 1U) != 0;
  if (bound_all(bytes.subspan(payload_at, payload_end - payload_at), list_little)) return true;

  std::array<std::uint8_t, 4 + kLease_bytes> lease{};
  write_number(std::span(lease).subspan(0, 2), kLeaseParameter, list_little);
  write_number(std::span(lease).subspan(2, 2), kLease_bytes, list_little);
  write_number(std::span(lease).subspan(4, 4), kShortestLease_s, list_little);
  const bool little = (bytes[submessage_at + 1] & 1U) != 0;
  const std::span<std::uint8_t> size_field = bytes.subspan(submessage_at + 2, 2);
  const std::size_t size = PacketReader(size_field, little).u16();
  if (size > 0) {  // 0: up to the end of the packet
    if (size + lease.size() > std::numeric_limits<std::uint16_t>::max()) return false;
    write_number(size_field, static_cast<std::uint16_t>(size + lease.size()), little);
  }
  packet.insert(packet.begin() + static_cast<std::ptrdiff_t>(payload_at + kListHeader_bytes),
                lease.begin(), lease.end());
  return true;
}

}  // namespace topogeo::messaging
