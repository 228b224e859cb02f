// A file that is read in large parts, with random access.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::recording {

class InputFile {
 public:
  /// Throws std::runtime_error if it cannot be opened or is not a regular file.
  explicit InputFile(const std::filesystem::path& path);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// The bytes from `offset` on, fewer than `count` at the end of the file; valid until the next
  /// call. Throws std::runtime_error if reading fails.
  std::span<const std::byte> view(std::uint64_t offset, std::size_t count);

 private:
  std::string name_;
  support::FileDescriptor file_;
  std::uint64_t size_ = 0;
  std::uint64_t window_start_ = 0;
  std::vector<std::byte> window_;
};

/// Thrown by a Cursor; callers that know the position in the file catch it.
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads little-endian numbers and counted bytes in order.
class Cursor {
 public:
  explicit Cursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const { return at_; }

  std::span<const std::byte> take(std::uint64_t count) {
    if (count > left()) {
      throw FormatError("expected " + std::to_string(count) + " bytes more, got " +
                        std::to_string(left()));
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  template <typename Value>
  Value number() {
    static_assert(std::is_integral_v<Value>);
    Value value{};
    std::memcpy(&value, take(sizeof(Value)).data(), sizeof(Value));
    return value;
  }

  std::string_view text(std::uint64_t count) {
    const std::span<const std::byte> bytes = take(count);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  /// Bytes after their 32-bit count.
  std::string_view counted_text() { return text(number<std::uint32_t>()); }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace topogeo::recording
