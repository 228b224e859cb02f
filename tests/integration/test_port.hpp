// A serial port whose far end belongs to the test: a pseudo-terminal behind a link that keeps its
// name when the terminal is replaced, like a device in /dev that is plugged in again.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace topogeo::test {

class TestPort {
 public:
  explicit TestPort(std::filesystem::path link) : link_(std::move(link)) {}
  TestPort(const TestPort&) = delete;
  TestPort& operator=(const TestPort&) = delete;
  ~TestPort() { unplug(); }

  void plug() {
    unplug();
    fd_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (fd_ < 0 || ::grantpt(fd_) != 0 || ::unlockpt(fd_) != 0) {
      throw std::runtime_error("no pseudo-terminal to be had");
    }
    std::filesystem::create_symlink(::ptsname(fd_), link_);
  }

  void unplug() {
    if (fd_ < 0) return;
    std::filesystem::remove(link_);
    ::close(fd_);
    fd_ = -1;
  }

  void send(const std::vector<std::uint8_t>& bytes) const {
    if (::write(fd_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the pseudo-terminal does not take the bytes");
    }
  }

  /// Bytes written by the other side; empty without any.
  [[nodiscard]] std::vector<std::uint8_t> receive() const {
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t got = ::read(fd_, bytes.data(), bytes.size());
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

  /// Speed set by the other side, as a constant of termios.h.
  [[nodiscard]] speed_t speed() const {
    termios settings{};
    if (::tcgetattr(fd_, &settings) != 0) throw std::runtime_error("not a terminal");
    return ::cfgetospeed(&settings);
  }

  [[nodiscard]] const std::filesystem::path& link() const { return link_; }

 private:
  std::filesystem::path link_;
  int fd_ = -1;
};

}  // namespace topogeo::test
