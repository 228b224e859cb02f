#include "parameter_check.hpp"

#include <cstddef>

#include "packet_reader.hpp"

namespace topogeo::messaging {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kEncapsulation_bytes = 4;
constexpr std::uint8_t kBigEndianList = 2;  // the little endian one is the next
constexpr std::uint8_t kLittleEndian = 1;   // bit of an encapsulation
/// Names of the middleware take up to 255 characters, and it cuts what is longer.
constexpr std::size_t kMaxName_bytes = 256;

enum Parameter : std::uint16_t {
  kSentinel = 0x0001,
  kLease = 0x0002,
  kTopicName = 0x0005,
  kTypeName = 0x0007,
  kLiveliness = 0x001b,
  kPartition = 0x0029,
  kUserData = 0x002c,
  kGroupData = 0x002d,
  kTopicData = 0x002e,
  kContentFilter = 0x0035,
  kProperties = 0x0059,
  kEntityName = 0x0062,
  kTypeId = 0x0069,
  kTypeObject = 0x0072,
  kDataRepresentation = 0x0073,
  kTypeInformation = 0x0075,
  kIdentityToken = 0x1001,
  kPermissionsToken = 0x1002,
  kDataSharing = 0x8006,
};

/// A text with its zero, and no other zero.
bool skip_text(PacketReader& reader, std::size_t most) {
  const std::uint32_t size = reader.u32();
  const Bytes text = reader.take(size);
  reader.align();
  if (!reader.ok() || size == 0 || size > most || text.back() != 0) return false;
  for (const std::uint8_t byte : text.first(size - 1)) {
    if (byte == 0) return false;
  }
  return true;
}

bool skip_bytes(PacketReader& reader) {
  reader.skip(reader.u32());
  reader.align();
  return reader.ok();
}

/// A number of things that each take `least` bytes or more.
std::uint32_t count_of(PacketReader& reader, std::size_t least, bool& ok) {
  const std::uint32_t count = reader.u32();
  ok = reader.ok() && count <= reader.left() / least;
  return ok ? count : 0;
}

bool skip_texts(PacketReader& reader, std::size_t texts_of_each) {
  bool ok = false;
  const std::uint32_t count = count_of(reader, 5 * texts_of_each, ok);
  for (std::size_t n = count * texts_of_each; ok && n > 0; --n) {
    ok = skip_text(reader, reader.left());
  }
  return ok;
}

bool skip_named_bytes(PacketReader& reader) {
  bool ok = false;
  const std::uint32_t count = count_of(reader, 9, ok);
  for (std::uint32_t n = 0; ok && n < count; ++n) {
    ok = skip_text(reader, reader.left()) && skip_bytes(reader);
  }
  return ok;
}

/// A DataHolder: the name of a class, properties, properties of bytes.
bool skip_holder(PacketReader& reader) {
  return skip_text(reader, reader.left()) && skip_texts(reader, 2) && skip_named_bytes(reader);
}

bool content_filter_valid(PacketReader& reader) {
  for (int text = 0; text < 3; ++text) {
    if (!skip_text(reader, kMaxName_bytes)) return false;
  }
  return skip_text(reader, reader.left()) && skip_texts(reader, 1);
}

/// Longer than none: a timer runs at its rate.
bool duration_valid(PacketReader& reader) {
  const std::uint32_t seconds = reader.u32();
  constexpr std::uint32_t kFirstNegative = 0x80000000;
  constexpr std::uint32_t kShortestFraction = 1U << 24U;  // 1/256 s
  const std::uint32_t fraction = reader.u32();
  return reader.ok() && seconds < kFirstNegative && (seconds > 0 || fraction >= kShortestFraction);
}

bool value_valid(std::uint16_t id, PacketReader reader) {
  switch (id) {
    case kEntityName:
    case kTopicName:
    case kTypeName:
      return skip_text(reader, kMaxName_bytes);
    case kPartition:
      return skip_texts(reader, 1) && reader.left() == 0;
    case kUserData:
    case kGroupData:
    case kTopicData:
      return skip_bytes(reader) && reader.left() == 0;
    case kProperties:
      return skip_texts(reader, 2);
    case kIdentityToken:
    case kPermissionsToken:
      return skip_holder(reader);
    case kContentFilter:
      return content_filter_valid(reader);
    case kDataRepresentation: {
      bool ok = false;
      count_of(reader, 2, ok);
      return ok;
    }
    case kDataSharing: {
      bool ok = false;
      count_of(reader, 8, ok);
      return ok;
    }
    case kLease:
      return duration_valid(reader);
    case kLiveliness:
      reader.skip(4);
      return duration_valid(reader);
    default:
      return true;
  }
}

bool describes_type(std::uint16_t id) {
  return id == kTypeId || id == kTypeObject || id == kTypeInformation;
}

}  // namespace

bool check_parameters(std::span<std::uint8_t> payload) {
  if (payload.size() < kEncapsulation_bytes || payload[0] != 0 ||
      (payload[1] | kLittleEndian) != (kBigEndianList | kLittleEndian)) {
    return false;
  }
  PacketReader reader(payload, (payload[1] & kLittleEndian) != 0);
  reader.skip(kEncapsulation_bytes);
  while (true) {
    const std::size_t at = reader.position();
    const std::uint16_t id = reader.u16();
    const std::uint16_t size = reader.u16();
    if (!reader.ok()) return false;
    if (id == kSentinel) return true;
    const Bytes value = reader.take(size);
    reader.align();
    if (!reader.ok() || !value_valid(id, PacketReader(value, reader.little_endian()))) return false;
    if (describes_type(id)) {
      payload[at] = 0;  // the parameter 0 is skipped
      payload[at + 1] = 0;
    }
  }
}

bool check_handshake(Bytes payload) {
  constexpr std::size_t kIdentities_bytes = 24 + 24;
  constexpr std::size_t kKeys_bytes = 16 + 16 + 16;
  if (payload.size() < kEncapsulation_bytes || payload[0] != 0 || payload[1] > kLittleEndian) {
    return false;
  }
  PacketReader reader(payload.subspan(kEncapsulation_bytes), payload[1] == kLittleEndian);
  reader.skip(kIdentities_bytes + kKeys_bytes);
  if (!skip_text(reader, reader.left())) return false;
  bool ok = false;
  // A holder has a name, a number of properties, a number of those of bytes.
  const std::uint32_t count = count_of(reader, 5 + 3 + 4 + 4, ok);
  for (std::uint32_t n = 0; ok && n < count; ++n) ok = skip_holder(reader);
  return ok;
}

}  // namespace topogeo::messaging
