// Numbers out of bytes, in the byte order of their sender and never beyond their end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace topogeo::messaging {

/// After a read beyond the end it is not ok and reads zeros.
class PacketReader {
 public:
  PacketReader(std::span<const std::uint8_t> bytes, bool little_endian)
      : bytes_(bytes), little_endian_(little_endian) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - position_; }
  [[nodiscard]] bool little_endian() const { return little_endian_; }

  void skip(std::size_t size) { static_cast<void>(take(size)); }
  /// Skips to a multiple of four, or to the end where that comes first.
  void align() {
    const std::size_t padding = (4 - position_ % 4) % 4;
    position_ += padding < left() ? padding : left();
  }
  std::span<const std::uint8_t> take(std::size_t size) {
    if (size > left()) {
      ok_ = false;
      position_ = bytes_.size();
      return {};
    }
    position_ += size;
    return bytes_.subspan(position_ - size, size);
  }
  std::uint8_t u8() { return number<std::uint8_t>(); }
  std::uint16_t u16() { return number<std::uint16_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  /// Reads a number as RTPS has it: the high half first, whatever the byte order.
  std::int64_t sequence_number() {
    const std::uint64_t high = u32();
    return static_cast<std::int64_t>(high << 32U | u32());
  }
  /// Four bytes in the order in which they stand.
  std::uint32_t entity() {
    std::uint32_t value = 0;
    for (const std::uint8_t byte : take(4)) value = value << 8U | byte;
    return value;
  }

 private:
  template <class Number>
  Number number() {
    std::uint32_t value = 0;
    const std::span<const std::uint8_t> bytes = take(sizeof(Number));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      value = value << 8U | bytes[little_endian_ ? bytes.size() - 1 - at : at];
    }
    return static_cast<Number>(value);
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  bool little_endian_;
  bool ok_ = true;
};

}  // namespace topogeo::messaging
