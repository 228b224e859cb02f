#include "packet_check.hpp"

#include <algorithm>
#include <array>

#include "packet_reader.hpp"
#include "submessages.hpp"

namespace topogeo::messaging {

namespace {

using Bytes = std::span<const std::uint8_t>;

/// A thousand samples a second for 35 years. Above it numbers would overflow.
constexpr std::int64_t kMaxSequenceNumber = std::int64_t{1} << 40U;
/// No sample is larger (fast_dds/fragments.cpp).
constexpr std::uint32_t kMaxSample_bytes = 64U << 20U;
constexpr std::uint8_t kMajorVersion = 2;
constexpr std::uint32_t kMaxSetBits = 256;
/// The middleware takes it without asking for its length.
constexpr std::size_t kLivelinessPayload_bytes = 20;

bool in_range(std::int64_t number) {
  return number > 0 && number <= kMaxSequenceNumber;
}

/// The set of a GAP, an ACKNACK or a NACK_FRAG after its base.
bool skip_set(PacketReader& reader) {
  const std::uint32_t bits = reader.u32();
  if (!reader.ok() || bits > kMaxSetBits) return false;
  reader.skip(std::size_t{4} * ((bits + 31) / 32));
  return reader.ok();
}

/// The beginning of DATA and DATA_FRAG.
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
  if (data.flag(1) && !read_inline_parameters(reader).valid) return false;
  if (!has_payload && !has_key) return true;
  const bool liveliness =
      header.writer == builtin::kLiveliness || header.writer == builtin::kSecureLiveliness;
  return reader.left() >= (liveliness ? kLivelinessPayload_bytes : kEncapsulation_bytes);
}

bool data_fragment_valid(const Submessage& data) {
  constexpr std::size_t kFixed_bytes = 32;
  PacketReader reader = data.reader();
  const SampleHeader header = sample_header(reader, kFixed_bytes);
  if (!header.valid || header.writer == builtin::kLiveliness) return false;
  const std::uint64_t first = reader.u32();
  const std::uint64_t count = reader.u16();
  const std::uint64_t size = reader.u16();
  const std::uint64_t sample = reader.u32();
  if (!reader.ok() || first == 0 || count == 0 || size == 0 || sample > kMaxSample_bytes ||
      (first - 1 + count - 1) * size >= sample) {
    return false;
  }
  if (data.flag(1) && !read_inline_parameters(reader).valid) return false;
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
    case Submessage::kData:
      return data_valid(submessage);
    case Submessage::kDataFragment:
      return data_fragment_valid(submessage);
    case Submessage::kHeartbeat:
      return heartbeat_valid(submessage);
    case Submessage::kGap:
      return gap_valid(submessage);
    case Submessage::kAckNack:
      return acknack_valid(submessage);
    case Submessage::kNackFragment:
      return nack_fragment_valid(submessage);
    case Submessage::kHeartbeatFragment:
      return submessage.body.size() >= 24;
    case Submessage::kInfoTimestamp:
      return submessage.flag(1) || submessage.body.size() >= 8;
    case Submessage::kInfoSource:
      return submessage.body.size() == 20;
    case Submessage::kInfoDestination:
      return submessage.body.size() >= 12;
    default:
      return true;
  }
}

/// Whether an endpoint is one of a topic, and not of the middleware itself.
bool is_of_topic(std::uint32_t entity) {
  constexpr std::uint32_t kOwner = 0xc0;  // bits of who made it: 0xc0 is the middleware
  return entity != 0 && (entity & kOwner) != kOwner;
}

/// Whether security encrypts what an endpoint sends and gets: all but what plain discovery and
/// authentication are made of (deploy/security/make_keys, governance).
bool is_protected(std::uint32_t entity) {
  constexpr std::uint32_t kSecure = 0xff000000;
  return is_of_topic(entity) || (entity & kSecure) == kSecure;
}

/// Whether a plain submessage is about samples that security protects. A participant with
/// security needs only the announcements of participants from plain discovery.
bool about_protected_samples(const Submessage& submessage) {
  const Endpoints ends = endpoints_of(submessage);
  switch (submessage.kind) {
    case Submessage::kData:
    case Submessage::kDataFragment:
      if (ends.writer == builtin::kWriters || ends.writer == builtin::kReaders) return true;
      break;
    case Submessage::kHeartbeat:
    case Submessage::kGap:
    case Submessage::kAckNack:
    case Submessage::kNackFragment:
      break;
    default:
      return false;
  }
  return is_protected(ends.writer) || is_protected(ends.reader);
}

/// Whether a submessage says that the whole packet is in one envelope. Peers send none: governance
/// protects submessages, not packets (rtps_protection_kind NONE). Fast DDS passes over such a
/// prefix where it is not the first, and reads what follows as plain submessages.
bool whole_envelope(const Submessage& submessage) {
  return submessage.kind == Submessage::kSecureMessagePrefix ||
         submessage.kind == Submessage::kSecureMessagePostfix;
}

}  // namespace

PacketCheck check_packet(Bytes packet, bool secured) {
  constexpr std::array<std::uint8_t, 4> kProtocol = {'R', 'T', 'P', 'S'};
  if (packet.size() < kRtpsHeader_bytes || !std::ranges::equal(packet.first(4), kProtocol) ||
      packet[4] != kMajorVersion) {
    return {};
  }
  PacketCheck check;
  check.valid = visit_submessages(packet, secured, [&](const Submessage& submessage) {
    const bool protected_samples = about_protected_samples(submessage);
    check.unprotected = check.unprotected || protected_samples || whole_envelope(submessage);
    check.unprotected_topic = check.unprotected_topic ||
                              (protected_samples && is_of_topic(endpoints_of(submessage).writer));
    check.announces = check.announces || is_announcement(submessage);
    return body_valid(submessage);
  });
  return check.valid ? check : PacketCheck{};
}

}  // namespace topogeo::messaging
