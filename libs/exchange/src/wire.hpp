// The fields of a Protobuf message, without their meaning (Protobuf, "Encoding").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace topogeo::exchange {

struct WireField {
  enum class Type : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
  std::uint32_t number = 0;
  Type type = Type::kVarint;
  std::uint64_t value = 0;     ///< of numbers
  std::string_view payload{};  ///< of kBytes
};

/// The field that begins at `at`, which is moved behind it. Returns nothing and keeps `at` if no
/// field begins there or the bytes end within it.
std::optional<WireField> read_field(std::string_view bytes, std::size_t& at);

/// The last value of a number in a message, which counts for Protobuf; nothing if there is none or
/// the message cannot be followed to its end.
std::optional<std::uint64_t> number_in(std::string_view message, std::uint32_t field);

/// A field as bytes.
std::string varint_field(std::uint32_t number, std::uint64_t value);
std::string fixed64_field(std::uint32_t number, std::uint64_t value);
std::string bytes_field(std::uint32_t number, std::string_view payload);

}  // namespace topogeo::exchange
