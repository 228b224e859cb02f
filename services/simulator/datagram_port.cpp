#include "datagram_port.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <sys/socket.h>

#include "topogeo/devices/network_address.hpp"

namespace topogeo::simulator {

DatagramPort::DatagramPort(std::string address, std::uint16_t port)
    : address_(std::move(address)), commands_(address_, port) {}

void DatagramPort::plug() {
  if (plugged()) return;
  commands_.plug();
  support::FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in at{};
  at.sin_family = AF_INET;
  if (::inet_pton(AF_INET, address_.c_str(), &at.sin_addr) != 1 || !socket.is_open() ||
      ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0) {  // NOLINT
    commands_.unplug();
    throw std::runtime_error("udp://" + address_ + ": cannot send: " + std::strerror(errno));
  }
  data_ = std::move(socket);
}

void DatagramPort::unplug() {
  commands_.unplug();
  data_ = support::FileDescriptor();
  receiver_ = {};
}

devices::LineSettings DatagramPort::host(devices::Parity parity) const {
  return commands_.host(parity);
}

void DatagramPort::set_receiver(std::span<const std::uint8_t> text) {
  const std::string url = "udp://" + std::string(text.begin(), text.end());
  receiver_ = {};
  try {
    const devices::NetworkAddress address = devices::network_address(url);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(address.port.value_or(0));
    if (::inet_pton(AF_INET, address.host.c_str(), &to.sin_addr) == 1) receiver_ = to;
  } catch (const std::invalid_argument&) {
    return;  // the program asked for no address
  }
}

std::size_t DatagramPort::send(std::span<const std::uint8_t> bytes) {
  std::size_t lost = 0;
  for (const devices::Envelope& envelope : envelopes_.read(bytes)) {
    if (envelope.kind == devices::EnvelopeKind::kHost) set_receiver(envelope.contents);
    if (envelope.kind == devices::EnvelopeKind::kReply) lost += commands_.send(envelope.contents);
    if (envelope.kind != devices::EnvelopeKind::kDatagram || receiver_.sin_port == 0) continue;
    const ssize_t sent = ::sendto(data_.get(), envelope.contents.data(), envelope.contents.size(),
                                  0, reinterpret_cast<const sockaddr*>(&receiver_),  // NOLINT
                                  sizeof receiver_);
    if (sent < 0) lost += envelope.contents.size();
  }
  return lost;
}

}  // namespace topogeo::simulator
