// A file descriptor that is closed with its owner.
#pragma once

#include <utility>

#include <unistd.h>

namespace topogeo::support {

class FileDescriptor {
 public:
  /// Takes the result of open() and the like; negative: owns nothing.
  explicit FileDescriptor(int number = -1) : number_(number) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor() {
    if (is_open()) ::close(number_);
  }

  [[nodiscard]] int get() const { return number_; }
  /// The number, which the caller closes.
  [[nodiscard]] int release() { return std::exchange(number_, -1); }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  /// Closes now; false with errno if the kernel reports a late write error. Only while open.
  bool close() { return ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_;
};

}  // namespace topogeo::support
