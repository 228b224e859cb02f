// A program's end of a serial port, and a name for its link.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

namespace topogeo::simulator {

inline std::filesystem::path link_name(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) /
         ("simulator-" + std::to_string(::getpid()) + "-" + name);
}

class HostPort {
 public:
  explicit HostPort(const std::filesystem::path& link)
      : fd_(::open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    if (fd_ < 0) throw std::runtime_error(link.string() + " cannot be opened");
  }
  HostPort(const HostPort&) = delete;
  HostPort& operator=(const HostPort&) = delete;
  ~HostPort() { ::close(fd_); }

  void set_rate(speed_t rate) const {
    termios settings{};
    if (::tcgetattr(fd_, &settings) != 0) throw std::runtime_error("not a terminal");
    ::cfsetispeed(&settings, rate);
    ::cfsetospeed(&settings, rate);
    if (::tcsetattr(fd_, TCSANOW, &settings) != 0) throw std::runtime_error("rate refused");
  }
  void write(std::string_view bytes) const {
    if (::write(fd_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the port takes no bytes");
    }
  }
  /// Returns the bytes available now.
  [[nodiscard]] std::string read() const {
    std::string all;
    std::array<char, 4096> part{};
    for (ssize_t got = 0; (got = ::read(fd_, part.data(), part.size())) > 0;) {
      all.append(part.data(), static_cast<std::size_t>(got));
    }
    return all;
  }
  /// Whether the far end is gone.
  [[nodiscard]] bool hung_up() const {
    char byte = 0;
    const ssize_t got = ::read(fd_, &byte, 1);
    return got == 0 || (got < 0 && errno == EIO);
  }

 private:
  int fd_;
};

}  // namespace topogeo::simulator
