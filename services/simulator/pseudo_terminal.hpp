// A serial port for programs on this machine whose far end belongs to a simulated device.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::simulator {

/// A pseudo-terminal behind a link of a fixed name, as a device in /dev keeps its name when it is
/// plugged in again.
class PseudoTerminal {
 public:
  /// Not plugged in yet.
  explicit PseudoTerminal(std::filesystem::path link);
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  /// Removes the link.
  ~PseudoTerminal();

  /// The port appears, at 9600 baud. A link that is there already, of a simulator that was killed,
  /// is replaced. Throws std::runtime_error naming the path when there is something else or no
  /// terminal can be had.
  void plug();
  /// The port disappears: whoever has it open reads an error.
  void unplug();
  [[nodiscard]] bool plugged() const { return host_end_.is_open(); }

  /// The rate that the program at the other end has set. A pseudo-terminal of Linux forgets the
  /// parity, so that it is taken for `parity`.
  [[nodiscard]] devices::LineSettings host(devices::Parity parity) const;
  /// All that the program has written since; empty when there is nothing.
  [[nodiscard]] std::vector<std::uint8_t> receive() const;
  /// What does not fit, because no program reads, is lost as on a line. Returns how much that is.
  std::size_t send(std::span<const std::uint8_t> bytes) const;

  [[nodiscard]] const std::filesystem::path& link() const { return link_; }

 private:
  std::filesystem::path link_;
  support::FileDescriptor device_end_;
  // Kept open, or the device would read errors while no program has it open.
  support::FileDescriptor host_end_;
};

}  // namespace topogeo::simulator
