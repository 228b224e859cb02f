// A small record in its own file, which outlives a killed process.
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

/// One record of bytes, overwritten in place. Each call hands it to the kernel, so it survives the
/// death of the process. It is not forced to disk: after a power failure the file may have an older
/// record, or none.
class RecordFileBytes {
 public:
  /// `format` names the layout of the record; a file with another format has no record. An empty
  /// path: nothing is stored. Throws std::runtime_error naming the file if it cannot be opened or
  /// created.
  RecordFileBytes(const std::filesystem::path& path, std::uint64_t format);

  /// Fills `bytes` with the last stored record. False if there is none, or if it is damaged or of
  /// another size or format.
  [[nodiscard]] bool load(std::span<std::byte> bytes) const;
  /// False if the record cannot be written: the previous one is lost with it, and the file is
  /// damaged. True without a file.
  [[nodiscard]] bool store(std::span<const std::byte> bytes) const;

 private:
  FileDescriptor file_;
  std::uint64_t format_;
};

/// The same for a record of type T, stored in the memory layout of this machine.
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
  [[nodiscard]] bool store(const T& record) const {
    return file_.store(std::as_bytes(std::span(&record, 1)));
  }

 private:
  RecordFileBytes file_;
};

}  // namespace topogeo::support
