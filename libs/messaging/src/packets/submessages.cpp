#include "submessages.hpp"

#include <algorithm>
#include <array>

namespace topogeo::messaging {

namespace {

constexpr std::uint32_t kKeyHash_bytes = 16;

enum InlineParameter : std::uint16_t {
  kLastParameter = 0x0001,
  kContentFilterInfo = 0x0055,
  kKeyHash = 0x0070,
  kStatusInfo = 0x0071,
};

/// Fast DDS ends each of its packets with statistics, and is sure to find them there.
bool misplaced_statistics(std::span<const std::uint8_t> packet, std::uint8_t kind,
                          std::size_t end) {
  constexpr std::array<std::uint8_t, 2> kVendor = {0x01, 0x0f};
  return kind == Submessage::kStatistics && end != packet.size() &&
         std::ranges::equal(packet.subspan(6, 2), kVendor);
}

bool filter_info_valid(PacketReader reader) {
  // Bits of results, then 16 bytes for each filter that was evaluated.
  const std::uint32_t results = reader.u32();
  if (results > reader.left() / 4) return false;
  reader.skip(std::size_t{results} * 4);
  const std::uint32_t filters = reader.u32();
  return reader.ok() && filters <= reader.left() / kKeyHash_bytes;
}

}  // namespace

Submessage submessage_at(std::span<const std::uint8_t> packet, std::size_t at) {
  Submessage submessage;
  if (packet.size() - at < 4) return submessage;
  PacketReader reader(packet.subspan(at), (packet[at + 1] & 1U) != 0);
  const std::uint8_t kind = reader.u8();
  submessage.flags = reader.u8();
  std::size_t size = reader.u16();
  // Zero: up to the end of the packet, but for those that may be empty.
  if (size == 0 && kind != Submessage::kInfoTimestamp && kind != Submessage::kPad) {
    size = reader.left();
  }
  const std::size_t end = std::min(at + 4 + (size + 3) / 4 * 4, packet.size());
  if (size > reader.left() || misplaced_statistics(packet, kind, end)) return submessage;
  submessage.kind = kind;
  submessage.body = reader.take(size);
  submessage.end = end;
  return submessage;
}

std::size_t end_of_envelope(std::span<const std::uint8_t> packet, const Submessage& prefix) {
  const Submessage content = submessage_at(packet, prefix.end);
  if (content.kind == Submessage::kNone || content.kind == Submessage::kSecurePrefix) return 0;
  const Submessage postfix = submessage_at(packet, content.end);
  return postfix.kind == Submessage::kSecurePostfix ? postfix.end : 0;
}

InlineParameters read_inline_parameters(PacketReader& reader) {
  constexpr std::size_t kStatus_bytes = 4;
  InlineParameters read;
  while (true) {
    const std::uint16_t id = reader.u16();
    const std::uint16_t size = reader.u16();
    if (!reader.ok()) return {};
    if (id == kLastParameter) {
      read.valid = true;
      return read;
    }
    const std::span<const std::uint8_t> value = reader.take(size);
    reader.align();
    if (!reader.ok() || (id == kKeyHash && size != kKeyHash_bytes) ||
        (id == kStatusInfo && size != kStatus_bytes) ||
        (id == kContentFilterInfo &&
         !filter_info_valid(PacketReader(value, reader.little_endian())))) {
      return {};
    }
    if (id == kKeyHash) read.key_hash = value;
    if (id == kStatusInfo) read.removal = read.removal || value.back() != 0;
  }
}

Endpoints endpoints_of(const Submessage& submessage) {
  constexpr std::size_t kBeforeReaderOfSample = 4;
  PacketReader reader = submessage.reader();
  if (submessage.is_sample()) reader.skip(kBeforeReaderOfSample);
  const std::uint32_t addressed = reader.entity();
  const std::uint32_t writer = reader.entity();
  return reader.ok() ? Endpoints{.reader = addressed, .writer = writer} : Endpoints{};
}

bool is_announcement(const Submessage& submessage) {
  if (!submessage.is_sample()) return false;
  const std::uint32_t writer = endpoints_of(submessage).writer;
  return writer == builtin::kParticipants || writer == builtin::kWriters ||
         writer == builtin::kReaders || writer == builtin::kHandshakes;
}

}  // namespace topogeo::messaging
