// Ports of a simulated device that takes commands over TCP and sends datagrams: the device speaks
// in envelopes (devices/envelope.hpp), one of which names the address for its datagrams.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <netinet/in.h>

#include "topogeo/devices/envelope.hpp"
#include "topogeo/support/file_descriptor.hpp"

#include "device_port.hpp"
#include "tcp_port.hpp"

namespace topogeo::simulator {

class DatagramPort final : public DevicePort {
 public:
  /// See TcpPort, whose address and port are those for commands.
  DatagramPort(std::string address, std::uint16_t port);

  [[nodiscard]] std::uint16_t port() const { return commands_.port(); }

  void plug() override;
  void unplug() override;
  [[nodiscard]] bool plugged() const override { return commands_.plugged(); }
  [[nodiscard]] devices::LineSettings host(devices::Parity parity) const override;
  [[nodiscard]] std::vector<std::uint8_t> receive() override { return commands_.receive(); }
  /// Takes envelopes, cut anywhere.
  std::size_t send(std::span<const std::uint8_t> bytes) override;

 private:
  void set_receiver(std::span<const std::uint8_t> text);

  std::string address_;
  TcpPort commands_;
  support::FileDescriptor data_;
  sockaddr_in receiver_{};  // its port is 0 as long as it is not known
  devices::EnvelopeReader envelopes_;
};

}  // namespace topogeo::simulator
