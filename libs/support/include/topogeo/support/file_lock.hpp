// A lock on a file that one process holds at a time. The kernel frees it however the process ends.
#pragma once

#include <chrono>
#include <filesystem>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::support {

class FileLock {
 public:
  /// Makes the file where there is none and writes into it who holds it; it stays there. Waits up
  /// to `patience` for a process that is ending. Throws std::runtime_error naming the file and the
  /// process that holds it, or why it cannot be locked.
  explicit FileLock(const std::filesystem::path& path,
                    std::chrono::milliseconds patience = std::chrono::milliseconds(0));

 private:
  FileDescriptor file_;
};

}  // namespace topogeo::support
