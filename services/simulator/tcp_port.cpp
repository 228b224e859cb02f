#include "tcp_port.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "topogeo/devices/network_address.hpp"

#include "datagram_port.hpp"
#include "pseudo_terminal.hpp"

namespace topogeo::simulator {

TcpPort::TcpPort(std::string address, std::uint16_t port)
    : address_(std::move(address)), port_(port) {}

void TcpPort::plug() {
  if (plugged()) return;
  support::FileDescriptor listener(
      ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port_);
  const int yes = 1;
  if (::inet_pton(AF_INET, address_.c_str(), &at.sin_addr) != 1 || !listener.is_open() ||
      ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 ||  // NOLINT
      ::listen(listener.get(), 1) != 0) {
    throw std::runtime_error("tcp://" + address_ + ":" + std::to_string(port_) +
                             ": cannot listen: " + std::strerror(errno));
  }
  socklen_t size = sizeof at;
  if (::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&at), &size) == 0) {  // NOLINT
    port_ = ntohs(at.sin_port);
  }
  listener_ = std::move(listener);
}

void TcpPort::unplug() {
  program_ = support::FileDescriptor();
  listener_ = support::FileDescriptor();
}

devices::LineSettings TcpPort::host(devices::Parity parity) const {
  constexpr std::uint32_t kFastest = 3'000'000;
  return {program_.is_open() ? kFastest : 0, parity};
}

std::vector<std::uint8_t> TcpPort::receive() {
  support::FileDescriptor next(
      ::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (next.is_open()) {
    const int yes = 1;
    static_cast<void>(::setsockopt(next.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes));
    program_ = std::move(next);
  }
  std::vector<std::uint8_t> bytes;
  if (!program_.is_open()) return bytes;
  std::array<std::uint8_t, 4096> part{};
  ssize_t got = 0;
  while ((got = ::recv(program_.get(), part.data(), part.size(), 0)) > 0) {
    bytes.insert(bytes.end(), part.begin(), part.begin() + got);
  }
  if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK)) program_ = support::FileDescriptor();
  return bytes;
}

std::size_t TcpPort::send(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || !program_.is_open()) return bytes.size();
  const ssize_t sent = ::send(program_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return bytes.size() - (sent > 0 ? static_cast<std::size_t>(sent) : 0);
}

std::unique_ptr<DevicePort> make_device_port(const std::filesystem::path& port) {
  const std::string text = port.string();
  if (!devices::is_network_address(text)) return std::make_unique<PseudoTerminal>(port);
  const devices::NetworkAddress address = devices::network_address(text);
  if (!address.port) {
    throw std::invalid_argument("'" + text +
                                "': expected tcp://ADDRESS:PORT or udp://ADDRESS:PORT");
  }
  if (address.datagrams) return std::make_unique<DatagramPort>(address.host, *address.port);
  return std::make_unique<TcpPort>(address.host, *address.port);
}

}  // namespace topogeo::simulator
