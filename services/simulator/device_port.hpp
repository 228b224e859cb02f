// The far end of a port for programs on this machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::simulator {

class DevicePort {
 public:
  DevicePort() = default;
  DevicePort(const DevicePort&) = delete;
  DevicePort& operator=(const DevicePort&) = delete;
  DevicePort(DevicePort&&) = delete;
  DevicePort& operator=(DevicePort&&) = delete;
  virtual ~DevicePort() = default;

  /// Makes the port appear. Throws std::runtime_error naming it.
  virtual void plug() = 0;
  /// Makes the port disappear: programs that have it open read an error.
  virtual void unplug() = 0;
  [[nodiscard]] virtual bool plugged() const = 0;
  /// The rate set by the program at the other end, and `parity`; a rate of 0: there is none now.
  [[nodiscard]] virtual devices::LineSettings host(devices::Parity parity) const = 0;
  /// Everything that the program has written since the last call; empty when there is nothing.
  [[nodiscard]] virtual std::vector<std::uint8_t> receive() = 0;
  /// Bytes that do not fit, because no program reads, are lost as on a line. Returns their number.
  virtual std::size_t send(std::span<const std::uint8_t> bytes) = 0;
};

/// "tcp://ADDRESS:PORT" or "udp://ADDRESS:PORT", at which one program at a time may connect, or the
/// link of a pseudo-terminal. Throws std::invalid_argument for an address of another form.
std::unique_ptr<DevicePort> make_device_port(const std::filesystem::path& port);

}  // namespace topogeo::simulator
