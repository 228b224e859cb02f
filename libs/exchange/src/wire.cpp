#include "wire.hpp"

#include <bit>

namespace topogeo::exchange {
namespace {

std::optional<std::uint64_t> read_varint(std::string_view bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && at < bytes.size(); shift += 7) {
    const auto byte = static_cast<unsigned char>(bytes[at++]);
    value |= static_cast<std::uint64_t>(byte & 0x7fU) << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> read_fixed(std::string_view bytes, std::size_t& at, std::size_t size) {
  if (bytes.size() - at < size) return std::nullopt;
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) {
    value = (value << 8U) | static_cast<unsigned char>(bytes[at + i]);
  }
  at += size;
  return value;
}

void append_varint(std::string& bytes, std::uint64_t value) {
  while (value >= 0x80U) {
    bytes += std::bit_cast<char>(static_cast<unsigned char>((value & 0x7fU) | 0x80U));
    value >>= 7U;
  }
  bytes += std::bit_cast<char>(static_cast<unsigned char>(value));
}

}  // namespace

std::optional<WireField> read_field(std::string_view bytes, std::size_t& at) {
  std::size_t next = at;
  const auto tag = read_varint(bytes, next);
  constexpr std::uint64_t kMostFields = 536'870'911;  // the limit of Protobuf
  if (!tag || (*tag >> 3U) == 0 || (*tag >> 3U) > kMostFields) return std::nullopt;
  WireField field;
  field.number = static_cast<std::uint32_t>(*tag >> 3U);
  field.type = static_cast<WireField::Type>(*tag & 7U);
  std::optional<std::uint64_t> value;
  switch (field.type) {
    case WireField::Type::kVarint:
    case WireField::Type::kBytes:
      value = read_varint(bytes, next);
      break;
    case WireField::Type::kFixed64:
      value = read_fixed(bytes, next, 8);
      break;
    case WireField::Type::kFixed32:
      value = read_fixed(bytes, next, 4);
      break;
  }
  if (!value) return std::nullopt;
  if (field.type == WireField::Type::kBytes) {
    if (bytes.size() - next < *value) return std::nullopt;
    field.payload = bytes.substr(next, *value);
    next += *value;
  } else {
    field.value = *value;
  }
  at = next;
  return field;
}

std::optional<std::uint64_t> number_in(std::string_view message, std::uint32_t field) {
  std::uint64_t value = 0;
  for (std::size_t at = 0; at < message.size();) {
    const auto read = read_field(message, at);
    if (!read) return std::nullopt;
    if (read->number == field) value = read->value;
  }
  return value;
}

std::string varint_field(std::uint32_t number, std::uint64_t value) {
  std::string bytes;
  append_varint(bytes, std::uint64_t{number} << 3U);
  append_varint(bytes, value);
  return bytes;
}

std::string fixed64_field(std::uint32_t number, std::uint64_t value) {
  std::string bytes;
  append_varint(bytes, (std::uint64_t{number} << 3U) | 1U);
  for (unsigned shift = 0; shift < 64; shift += 8) {
    bytes += std::bit_cast<char>(static_cast<unsigned char>((value >> shift) & 0xffU));
  }
  return bytes;
}

std::string bytes_field(std::uint32_t number, std::string_view payload) {
  std::string bytes;
  append_varint(bytes, (std::uint64_t{number} << 3U) | 2U);
  append_varint(bytes, payload.size());
  return bytes.append(payload);
}

}  // namespace topogeo::exchange
