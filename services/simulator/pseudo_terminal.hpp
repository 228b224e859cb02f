// A serial port for programs on this machine, with a simulated device at its far end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/support/file_descriptor.hpp"

#include "device_port.hpp"

namespace topogeo::simulator {

/// A pseudo-terminal behind a link of a fixed name, like a device in /dev that keeps its name when
/// it is plugged in again.
class PseudoTerminal final : public DevicePort {
 public:
  /// Not yet plugged in.
  explicit PseudoTerminal(std::filesystem::path link);
  /// Removes the link.
  ~PseudoTerminal() override;

  /// Makes the port appear, at 9600 baud. An existing link, left by a simulator that was killed, is
  /// replaced. Throws std::runtime_error naming the path when it is something else or no terminal
  /// is available.
  void plug() override;
  /// Makes the port disappear: programs that have it open read an error.
  void unplug() override;
  [[nodiscard]] bool plugged() const override { return host_end_.is_open(); }

  /// The rate set by the program at the other end. A Linux pseudo-terminal does not keep the
  /// parity, so the result has `parity`.
  [[nodiscard]] devices::LineSettings host(devices::Parity parity) const override;
  /// Everything that the program has written since the last call; empty when there is nothing.
  [[nodiscard]] std::vector<std::uint8_t> receive() override;
  /// Bytes that do not fit, because no program reads, are lost as on a line. Returns their number.
  std::size_t send(std::span<const std::uint8_t> bytes) override;

  [[nodiscard]] const std::filesystem::path& link() const { return link_; }

 private:
  std::filesystem::path link_;
  support::FileDescriptor device_end_;
  // Kept open, because the device would read errors while no program has it open.
  support::FileDescriptor host_end_;
};

}  // namespace topogeo::simulator
