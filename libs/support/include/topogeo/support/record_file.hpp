// A small record in a file of its own that outlives a process that is killed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <type_traits>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::support {

/// One record of bytes, overwritten in place. It reaches the file with each call, which the loss of
/// the process does not take away. It is not forced to disk: after a loss of power the file may
/// have an older record, or none.
class RecordFileBytes {
 public:
  /// `format` names the layout of the record; a file with another one has no record. An empty path:
  /// nothing is kept. Throws std::runtime_error naming the file when it cannot be opened or made.
  RecordFileBytes(const std::filesystem::path& path, std::uint64_t format);

  /// Fills `bytes` with the record that was stored last. False when there is none, or when it is
  /// damaged or of another size or format.
  [[nodiscard]] bool load(std::span<std::byte> bytes) const;
  /// A record that cannot be written is lost, and the one before with it.
  void store(std::span<const std::byte> bytes) const;

 private:
  FileDescriptor file_;
  std::uint64_t format_;
};

/// The same for a record of type T, which lies in the file as it does in the memory of this
/// machine.
template <class T>
class RecordFile {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  RecordFile(const std::filesystem::path& path, std::uint64_t format) : file_(path, format) {}

  [[nodiscard]] std::optional<T> load() const {
    std::array<std::byte, sizeof(T)> bytes{};
    if (!file_.load(bytes)) return std::nullopt;
    T record;
    std::memcpy(&record, bytes.data(), bytes.size());
    return record;
  }
  void store(const T& record) const { file_.store(std::as_bytes(std::span(&record, 1))); }

 private:
  RecordFileBytes file_;
};

}  // namespace topogeo::support
