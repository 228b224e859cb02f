// A file that is written from front to back; every failure throws.
#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

namespace topogeo::recording {

class OutputStream {
 public:
  explicit OutputStream(const std::filesystem::path& path)
      : name_(path.string()), file_(path, std::ios::binary | std::ios::trunc) {
    check();
  }

  void write(std::span<const std::byte> bytes) {
    file_.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
    check();
    at_ += bytes.size();
  }
  /// Overwrites bytes at `offset`; the position for further output is kept.
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    file_.seekp(static_cast<std::streamoff>(offset));
    file_.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
    file_.seekp(static_cast<std::streamoff>(at_));
    check();
  }
  void close() {
    file_.close();
    check();
  }
  [[nodiscard]] std::uint64_t at() const { return at_; }

 private:
  void check() const {
    if (!file_) throw std::runtime_error(name_ + ": cannot write: " + std::strerror(errno));
  }

  std::string name_;
  std::ofstream file_;
  std::uint64_t at_ = 0;
};

}  // namespace topogeo::recording
