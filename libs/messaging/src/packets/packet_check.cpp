#include "packet_check.hpp"

#include <algorithm>
#include <array>

#include "packet_reader.hpp"

namespace topogeo::messaging {

namespace {

using Bytes = std::span<const std::uint8_t>;

/// A thousand samples a second for 35 years. Above it numbers would overflow.
constexpr std::int64_t kMaxSequenceNumber = std::int64_t{1} << 40U;
/// No sample is larger (fragments.cpp).
constexpr std::uint32_t kMaxSample_bytes = 64U << 20U;
constexpr std::size_t kHeader_bytes = 20;
constexpr std::uint8_t kMajorVersion = 2;
constexpr std::uint32_t kMaxSetBits = 256;
constexpr std::uint32_t kKeyHash_bytes = 16;
/// Writers whose payload the middleware takes without asking for its length.
constexpr std::uint32_t kLivelinessWriter = 0x000200c2;
constexpr std::uint32_t kSecureLivelinessWriter = 0xff0200c2;
constexpr std::size_t kLivelinessPayload_bytes = 20;
/// What authentication itself is made of, so security does not protect it.
constexpr std::uint32_t kParticipantWriter = 0x000100c2;
constexpr std::uint32_t kHandshakeWriter = 0x000201c3;

enum Kind : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoDestination = 0x0e,
  kNackFragment = 0x12,
  kHeartbeatFragment = 0x13,
  kData = 0x15,
  kDataFragment = 0x16,
  kSecurePrefix = 0x31,
  kSecurePostfix = 0x32,
  kSecureMessagePrefix = 0x33,
  kSecureMessagePostfix = 0x34,
  kStatistics = 0x80,  // of the vendor of Fast DDS
};

enum InlineParameter : std::uint16_t {
  kLastParameter = 0x0001,
  kContentFilterInfo = 0x0055,
  kKeyHash = 0x0070,
  kStatusInfo = 0x0071,
};

struct Submessage {
  std::uint8_t kind = 0;
  std::uint8_t flags = 0;
  Bytes body;
  std::size_t end = 0;  // where the next one begins, in the packet

  [[nodiscard]] bool flag(unsigned bit) const { return (flags >> bit & 1U) != 0; }
  [[nodiscard]] PacketReader reader() const { return {body, flag(0)}; }
};

bool in_range(std::int64_t number) {
  return number > 0 && number <= kMaxSequenceNumber;
}

/// Fast DDS ends each of its packets with statistics, and is sure to find them there.
bool misplaced_statistics(Bytes packet, std::uint8_t kind, std::size_t end) {
  constexpr std::array<std::uint8_t, 2> kVendor = {0x01, 0x0f};
  return kind == kStatistics && end != packet.size() &&
         std::ranges::equal(packet.subspan(6, 2), kVendor);
}

/// Reads a submessage header and what belongs to it; its kind is 0 when the packet ends before, or
/// goes on where it must not.
Submessage submessage_at(Bytes packet, std::size_t at) {
  Submessage submessage;
  if (packet.size() - at < 4) return submessage;
  PacketReader reader(packet.subspan(at), (packet[at + 1] & 1U) != 0);
  const std::uint8_t kind = reader.u8();
  submessage.flags = reader.u8();
  std::size_t size = reader.u16();
  // Zero: up to the end of the packet, but for those that may be empty.
  if (size == 0 && kind != kInfoTimestamp && kind != kPad) size = reader.left();
  const std::size_t end = std::min(at + 4 + (size + 3) / 4 * 4, packet.size());
  if (size > reader.left() || misplaced_statistics(packet, kind, end)) return submessage;
  submessage.kind = kind;
  submessage.body = reader.take(size);
  submessage.end = end;
  return submessage;
}

/// The set of a GAP, an ACKNACK or a NACK_FRAG after its base.
bool skip_set(PacketReader& reader) {
  const std::uint32_t bits = reader.u32();
  if (!reader.ok() || bits > kMaxSetBits) return false;
  reader.skip(std::size_t{4} * ((bits + 31) / 32));
  return reader.ok();
}

bool filter_info_valid(PacketReader reader) {
  // Bits of results, then 16 bytes for each filter that was evaluated.
  const std::uint32_t results = reader.u32();
  if (results > reader.left() / 4) return false;
  reader.skip(std::size_t{results} * 4);
  const std::uint32_t filters = reader.u32();
  return reader.ok() && filters <= reader.left() / kKeyHash_bytes;
}

bool skip_inline_parameters(PacketReader& reader) {
  while (true) {
    const std::uint16_t id = reader.u16();
    const std::uint16_t size = reader.u16();
    if (!reader.ok()) return false;
    if (id == kLastParameter) return true;
    const Bytes value = reader.take(size);
    reader.align();
    if (!reader.ok() || (id == kKeyHash && size != kKeyHash_bytes) ||
        (id == kStatusInfo && size != 4) ||
        (id == kContentFilterInfo &&
         !filter_info_valid(PacketReader(value, reader.little_endian())))) {
      return false;
    }
  }
}

/// What DATA and DATA_FRAG begin with.
struct SampleHeader {
  bool valid = false;
  std::uint32_t writer = 0;
};

/// `size`: of all that stands before the inline parameters. All versions 2.x have the same.
SampleHeader sample_header(PacketReader& reader, std::size_t size) {
  reader.skip(2);
  const std::size_t to_parameters = reader.u16();
  const bool known = reader.position() + to_parameters == size;
  reader.skip(4);
  const std::uint32_t writer = reader.entity();
  const bool numbered = in_range(reader.sequence_number());
  return {.valid = reader.ok() && known && numbered, .writer = writer};
}

bool data_valid(const Submessage& data) {
  constexpr std::size_t kFixed_bytes = 20;
  constexpr std::size_t kEncapsulation_bytes = 4;
  const bool has_payload = data.flag(2);
  const bool has_key = data.flag(3);
  PacketReader reader = data.reader();
  const SampleHeader header = sample_header(reader, kFixed_bytes);
  if (!header.valid || (has_payload && has_key)) return false;
  if (data.flag(1) && !skip_inline_parameters(reader)) return false;
  if (!has_payload && !has_key) return true;
  const bool liveliness =
      header.writer == kLivelinessWriter || header.writer == kSecureLivelinessWriter;
  return reader.left() >= (liveliness ? kLivelinessPayload_bytes : kEncapsulation_bytes);
}

bool data_fragment_valid(const Submessage& data) {
  constexpr std::size_t kFixed_bytes = 32;
  PacketReader reader = data.reader();
  const SampleHeader header = sample_header(reader, kFixed_bytes);
  if (!header.valid || header.writer == kLivelinessWriter) return false;
  const std::uint64_t first = reader.u32();
  const std::uint64_t count = reader.u16();
  const std::uint64_t size = reader.u16();
  const std::uint64_t sample = reader.u32();
  if (!reader.ok() || first == 0 || count == 0 || size == 0 || sample > kMaxSample_bytes ||
      (first - 1 + count - 1) * size >= sample) {
    return false;
  }
  if (data.flag(1) && !skip_inline_parameters(reader)) return false;
  return reader.left() >= std::min(count * size, sample - (first - 1) * size);
}

bool heartbeat_valid(const Submessage& heartbeat) {
  PacketReader reader = heartbeat.reader();
  reader.skip(8);
  const std::int64_t first = reader.sequence_number();
  const std::int64_t last = reader.sequence_number();
  reader.skip(4);
  return reader.ok() && in_range(first) && last >= first - 1 && last <= kMaxSequenceNumber;
}

bool gap_valid(const Submessage& gap) {
  PacketReader reader = gap.reader();
  reader.skip(8);
  const std::int64_t first = reader.sequence_number();
  const std::int64_t end = reader.sequence_number();
  return in_range(first) && in_range(end) && skip_set(reader);
}

bool acknack_valid(const Submessage& acknack) {
  PacketReader reader = acknack.reader();
  reader.skip(8);
  const std::int64_t base = reader.sequence_number();
  if (base < 0 || base > kMaxSequenceNumber || !skip_set(reader)) return false;
  reader.skip(4);
  return reader.ok();
}

bool nack_fragment_valid(const Submessage& nack) {
  PacketReader reader = nack.reader();
  reader.skip(8);
  const std::int64_t number = reader.sequence_number();
  const std::uint32_t base = reader.u32();
  if (!in_range(number) || base == 0 || base > kMaxSample_bytes || !skip_set(reader)) return false;
  reader.skip(4);
  return reader.ok();
}

bool body_valid(const Submessage& submessage) {
  switch (submessage.kind) {
    case kData:
      return data_valid(submessage);
    case kDataFragment:
      return data_fragment_valid(submessage);
    case kHeartbeat:
      return heartbeat_valid(submessage);
    case kGap:
      return gap_valid(submessage);
    case kAckNack:
      return acknack_valid(submessage);
    case kNackFragment:
      return nack_fragment_valid(submessage);
    case kHeartbeatFragment:
      return submessage.body.size() >= 24;
    case kInfoTimestamp:
      return submessage.flag(1) || submessage.body.size() >= 8;
    case kInfoSource:
      return submessage.body.size() == 20;
    case kInfoDestination:
      return submessage.body.size() >= 12;
    default:
      return true;
  }
}

/// Whether a submessage is about samples that security would protect.
bool about_samples(const Submessage& submessage) {
  switch (submessage.kind) {
    case kData:
    case kDataFragment: {
      PacketReader reader = submessage.reader();
      reader.skip(8);
      const std::uint32_t writer = reader.entity();
      return writer != kParticipantWriter && writer != kHandshakeWriter;
    }
    case kHeartbeat:
    case kGap:
    case kAckNack:
    case kNackFragment:
      return true;
    default:
      return false;
  }
}

/// Whether a submessage says that the whole packet is in one envelope. Peers send none: governance
/// protects submessages, not packets (rtps_protection_kind NONE). Fast DDS passes over such a
/// prefix where it is not the first, and reads what follows as plain submessages.
bool whole_envelope(const Submessage& submessage) {
  return submessage.kind == kSecureMessagePrefix || submessage.kind == kSecureMessagePostfix;
}

/// The end of an envelope: a prefix, one submessage, a postfix. 0 when there is none.
std::size_t end_of_envelope(Bytes packet, const Submessage& prefix) {
  const Submessage content = submessage_at(packet, prefix.end);
  if (content.kind == 0 || content.kind == kSecurePrefix) return 0;
  const Submessage postfix = submessage_at(packet, content.end);
  return postfix.kind == kSecurePostfix ? postfix.end : 0;
}

}  // namespace

PacketCheck check_packet(Bytes packet) {
  constexpr std::array<std::uint8_t, 4> kProtocol = {'R', 'T', 'P', 'S'};
  if (packet.size() < kHeader_bytes || !std::ranges::equal(packet.first(4), kProtocol) ||
      packet[4] != kMajorVersion) {
    return {};
  }
  PacketCheck check{.valid = true};
  for (std::size_t at = kHeader_bytes; at < packet.size();) {
    const Submessage submessage = submessage_at(packet, at);
    if (submessage.kind == 0 || !body_valid(submessage)) return {};
    at = submessage.end;
    if (submessage.kind == kSecurePrefix) {
      at = end_of_envelope(packet, submessage);
      if (at == 0) return {};
    }
    check.unprotected =
        check.unprotected || about_samples(submessage) || whole_envelope(submessage);
  }
  return check;
}

}  // namespace topogeo::messaging
