// A TCP port for a program, with a simulated device behind it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/support/file_descriptor.hpp"

#include "device_port.hpp"

namespace topogeo::simulator {

class TcpPort final : public DevicePort {
 public:
  /// `address` is one of this machine, in dotted numbers; port 0 selects a free port. plug() opens
  /// it.
  TcpPort(std::string address, std::uint16_t port);

  [[nodiscard]] std::uint16_t port() const { return port_; }

  void plug() override;
  void unplug() override;
  [[nodiscard]] bool plugged() const override { return listener_.is_open(); }
  /// Returns the largest rate, because a network has none.
  [[nodiscard]] devices::LineSettings host(devices::Parity parity) const override;
  /// Accepts a program that connects; it replaces the previous one.
  [[nodiscard]] std::vector<std::uint8_t> receive() override;
  std::size_t send(std::span<const std::uint8_t> bytes) override;

 private:
  std::string address_;
  std::uint16_t port_;
  support::FileDescriptor listener_;
  support::FileDescriptor program_;
};

}  // namespace topogeo::simulator
