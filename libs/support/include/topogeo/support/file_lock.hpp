// A lock on a file, held by one process at a time. The kernel frees it however the process ends.
#pragma once

#include <chrono>
#include <filesystem>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::support {

class FileLock {
 public:
  /// Creates the file if needed and writes the holder into it; the file stays. Waits up to
  /// `patience` for a process that is ending. Throws std::runtime_error naming the file and the
  /// process that holds it, or the reason why it cannot be locked.
  explicit FileLock(const std::filesystem::path& path,
                    std::chrono::milliseconds patience = std::chrono::milliseconds(0));

 private:
  FileDescriptor file_;
};

}  // namespace topogeo::support
