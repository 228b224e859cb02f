#include "pseudo_terminal.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): posix_openpt is not in <cstdlib>
#include <termios.h>
#include <unistd.h>

#include "topogeo/support/line_rate.hpp"

namespace topogeo::simulator {
namespace {

std::runtime_error failure(const std::filesystem::path& link, const std::string& what) {
  return std::runtime_error(link.string() + ": " + what + ": " + std::strerror(errno));
}

/// Sets a port to the state before its configuration: raw bytes, no echo, 9600 baud.
bool make_raw(int terminal) {
  termios settings{};
  if (::tcgetattr(terminal, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  ::cfsetispeed(&settings, B9600);
  ::cfsetospeed(&settings, B9600);
  return ::tcsetattr(terminal, TCSANOW, &settings) == 0;
}

}  // namespace

PseudoTerminal::PseudoTerminal(std::filesystem::path link) : link_(std::move(link)) {}

PseudoTerminal::~PseudoTerminal() {
  unplug();
}

void PseudoTerminal::plug() {
  if (plugged()) return;
  if (std::filesystem::is_symlink(link_)) {
    std::filesystem::remove(link_);
  } else if (std::filesystem::exists(link_)) {
    throw std::runtime_error(link_.string() + ": expected nothing or a link, found something else");
  }
  support::FileDescriptor device_end(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> name{};
  if (!device_end.is_open() || ::grantpt(device_end.get()) != 0 ||
      ::unlockpt(device_end.get()) != 0 ||
      ::ptsname_r(device_end.get(), name.data(), name.size()) != 0) {
    throw failure(link_, "cannot make a pseudo-terminal");
  }
  support::FileDescriptor host_end(::open(name.data(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!host_end.is_open() || !make_raw(host_end.get())) {
    throw failure(link_, "cannot configure the pseudo-terminal");
  }
  std::error_code error;
  std::filesystem::create_symlink(name.data(), link_, error);
  if (error)
    throw std::runtime_error(link_.string() + ": cannot make the link: " + error.message());
  device_end_ = std::move(device_end);
  host_end_ = std::move(host_end);
}

void PseudoTerminal::unplug() {
  if (!plugged()) return;
  std::error_code ignored;
  if (std::filesystem::is_symlink(link_, ignored)) std::filesystem::remove(link_, ignored);
  host_end_ = support::FileDescriptor();
  device_end_ = support::FileDescriptor();
}

devices::LineSettings PseudoTerminal::host(devices::Parity parity) const {
  return {support::line_rate(device_end_.get()), parity};
}

std::vector<std::uint8_t> PseudoTerminal::receive() {
  // One read may end at the bytes of an earlier write. Linux delivers bytes still under way only to
  // a read that finds none.
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, 4096> part{};
  for (ssize_t got = 0; (got = ::read(device_end_.get(), part.data(), part.size())) > 0;) {
    bytes.insert(bytes.end(), part.begin(), part.begin() + got);
  }
  return bytes;
}

std::size_t PseudoTerminal::send(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return 0;
  const ssize_t sent = ::write(device_end_.get(), bytes.data(), bytes.size());
  return bytes.size() - (sent > 0 ? static_cast<std::size_t>(sent) : 0);
}

}  // namespace topogeo::simulator
