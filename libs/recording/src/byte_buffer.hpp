// Builds the bytes of a file, little endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace topogeo::recording {

class ByteBuffer {
 public:
  template <typename Value>
  ByteBuffer& number(Value value) {
    static_assert(std::is_integral_v<Value>);
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(Value));
    return *this;
  }
  ByteBuffer& raw(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  ByteBuffer& raw(std::string_view text) { return raw(std::as_bytes(std::span(text))); }
  /// Appends the 32-bit length, then the text.
  ByteBuffer& text(std::string_view text) {
    return number(static_cast<std::uint32_t>(text.size())).raw(text);
  }
  ByteBuffer& counted(const ByteBuffer& bytes) {
    return number(static_cast<std::uint32_t>(bytes.size())).raw(bytes.bytes());
  }

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace topogeo::recording
